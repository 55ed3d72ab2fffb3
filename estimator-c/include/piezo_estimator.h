/* The piezo estimator for programs in C: the bytes of a parameter table in, ticks out.
 *
 * Made from estimator-c/src; a test compares. examples/tick.c uses it.
 *
 * Memory is the caller's: a PiezoEstimator or PiezoInverse is static, or begins as {0}. Nothing is allocated or global.
 * Every function returns a PiezoResult, and writes its results, but for a reason, only where that is
 * PIEZO_RESULT_OK. The functions whose
 * names end in tick, tick_volts or release may be called from an interrupt, never while another function works on the same
 * structure. The stack must have PIEZO_BEGIN_STACK_BYTES free for piezo_table_read and those that begin. */

#ifndef PIEZO_ESTIMATOR_H
#define PIEZO_ESTIMATOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Bits of `PiezoEstimate.status`: the ADC stands at an end of its range.
#define PIEZO_ADC_SATURATED 1

// The voltage is beyond those the model was identified on; the nearest was taken.
#define PIEZO_VOLTAGE_OUT_OF_RANGE 2

// The displacement was clamped to the table's limits.
#define PIEZO_CLAMPED 4

// The DAC's code stands at an end of its range.
#define PIEZO_DAC_SATURATED 8

// The estimate still depends on where it was assumed to start, or on voltages beyond the table's range since.
#define PIEZO_NOT_SETTLED 16

// The voltage has gone as it never went in the training.
#define PIEZO_UNTRAINED 64

// Words of a `PiezoEstimator`.
#define PIEZO_ESTIMATOR_WORDS 1024

// Words of a `PiezoInverse`.
#define PIEZO_INVERSE_WORDS 512

// Bytes of stack that `piezo_table_read` and the functions that begin take at most.
#define PIEZO_BEGIN_STACK_BYTES 24576

// How a call went. As wide as a `uint32_t`, whatever a compiler makes of an enum.
enum PiezoResult
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // All went as asked, and the results are written.
  PIEZO_RESULT_OK = 0,
  // A pointer is null.
  PIEZO_RESULT_NULL = 1,
  // The value was not begun.
  PIEZO_RESULT_NOT_BEGUN = 2,
  // A number is NaN or infinite; nothing has changed.
  PIEZO_RESULT_NOT_FINITE = 3,
  // The record ends before its own length says.
  PIEZO_RESULT_TRUNCATED = 4,
  // The bytes are no parameter table: an erased page, or something else.
  PIEZO_RESULT_NOT_A_TABLE = 5,
  // A record of another format version.
  PIEZO_RESULT_VERSION = 6,
  // The record's checksum does not match.
  PIEZO_RESULT_CHECKSUM = 7,
  // The checksum matches, but the content is no table of this version, or a number in it breaks a rule.
  PIEZO_RESULT_CONTENT = 8,
  // The model is not stable, or not bounded by the table's limits.
  PIEZO_RESULT_INADMISSIBLE = 9,
  // The table has no inverse: its model has none, or it states no drive limits and none were given.
  PIEZO_RESULT_NO_INVERSE = 10,
  // The drive limits break a rule.
  PIEZO_RESULT_LIMITS = 11,
  // The displacement may not be told yet: before the first tick, or while an actuator that moved then is on its way.
  PIEZO_RESULT_TOO_SOON = 12,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PiezoResult PiezoResult;
#else
typedef uint32_t PiezoResult;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Memory of an estimator. Static memory, or `= {0}`; nothing in it is the caller's to read.
typedef struct PiezoEstimator {
  uint32_t begun;
  uint64_t words[PIEZO_ESTIMATOR_WORDS];
} PiezoEstimator;

// What a tick gives.
typedef struct PiezoEstimate {
  // Displacement at the next tick, µm.
  float displacement_um;
  // Half the width of its 95 % interval, µm; NaN where the table has none, the displacement was never told, or the
  // voltage is beyond the table's range or at an end of the ADC's.
  float half_width_um;
  // The displacement as a DAC with the table's calibration takes it, right-aligned.
  uint16_t dac_code;
  // `PIEZO_ADC_SATURATED` and the others; 0 where there is nothing to report.
  uint8_t status;
} PiezoEstimate;

// Memory of an inverse. Static memory, or `= {0}`; nothing in it is the caller's to read.
typedef struct PiezoInverse {
  uint32_t begun;
  uint64_t words[PIEZO_INVERSE_WORDS];
} PiezoInverse;

// What an amplifier may be driven to.
typedef struct PiezoDriveLimits {
  // Least amplifier voltage, V; within those that the model was identified on.
  float voltage_min_v;
  // Largest amplifier voltage, V; within those that the model was identified on.
  float voltage_max_v;
  // Amplifier voltage when nothing is wanted, V.
  float rest_v;
  // Fastest change, V/s.
  float slew_v_per_s;
} PiezoDriveLimits;

// What a tick gives.
typedef struct PiezoCommand {
  // Amplifier voltage from the next tick on, V.
  float voltage_v;
  // Displacement that the model reaches with it a tick later, µm relative to its zero.
  float displacement_um;
  // Whether that is what was wanted. Where not, a limit of voltage or slew rate keeps it away.
  bool reached;
} PiezoCommand;

// What a table says of itself.
typedef struct PiezoTable {
  // Time between two ticks, µs; 500 is 2 kHz. Ticks at another rate give other numbers.
  uint32_t sample_period_us;
  // Amplifier voltages that the model was identified on, V. Beyond, the estimate stands still and says so.
  float voltage_min_v;
  // The upper end of them, V.
  float voltage_max_v;
  // The estimate never leaves these but by what it was told, µm relative to the model's zero.
  float displacement_min_um;
  // The upper end of them, µm.
  float displacement_max_um;
  // Reading of the sensor that the model calls 0, µm.
  float displacement_zero_um;
  // Whether it states limits within which an amplifier may be driven.
  bool has_drive;
  // Whether it states how far the estimate may be off.
  bool has_interval;
} PiezoTable;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Begins an estimator with a parameter table, the bytes of `table.bin`; they are not needed afterwards. The actuator
// is assumed to have rested at the first tick's voltage. A table that is refused leaves the structure as it was. Not
// for an interrupt: it checks the whole table.
//
// # Safety
// `record` points to `length` bytes, and `estimator` to a structure that nobody else uses.
PiezoResult piezo_estimator_begin(struct PiezoEstimator *estimator, const uint8_t *record, size_t length);

// One tick with the code of an ADC with the table's calibration. May be called from an
// interrupt.
//
// # Safety
// `estimator` points to an initialised structure that nobody else uses, and `estimate` to a structure.
PiezoResult piezo_estimator_tick(struct PiezoEstimator *estimator, uint16_t adc_code, struct PiezoEstimate *estimate);

// One tick with the amplifier's voltage, V, for an ADC that is not the table's.
//
// # Safety
// As `piezo_estimator_tick`.
PiezoResult piezo_estimator_tick_volts(struct PiezoEstimator *estimator,
                                       float voltage_v,
                                       struct PiezoEstimate *estimate);

// Starts anew, from rest at the next tick's voltage; what was told is forgotten.
//
// # Safety
// `estimator` points to an initialised structure that nobody else uses.
PiezoResult piezo_estimator_restart(struct PiezoEstimator *estimator);

// Starts anew from a known displacement, µm relative to the model's zero. One beyond the table's limits
// becomes the nearest.
//
// # Safety
// As `piezo_estimator_restart`.
PiezoResult piezo_estimator_start_at(struct PiezoEstimator *estimator, float displacement_um);

// Calls the displacement of now `at_um`, where a stop, a gauge or rest tells it; the interval is relative to it.
// `PIEZO_RESULT_TOO_SOON` where it may not be told yet.
//
// # Safety
// As `piezo_estimator_restart`.
PiezoResult piezo_estimator_set_zero(struct PiezoEstimator *estimator, float at_um);

// Begins an inverse with a parameter table, long at rest at the rest voltage. `limits` may be null: then they
// are the table's own. **The amplifier must stand at the rest voltage**: the first tick goes on from there. Not
// for an interrupt.
//
// # Safety
// `record` points to `length` bytes, `limits` to a structure or is null, and `inverse` to a structure that
// nobody else uses.
PiezoResult piezo_inverse_begin(struct PiezoInverse *inverse,
                                const uint8_t *record,
                                size_t length,
                                const struct PiezoDriveLimits *limits);

// One tick: the voltage for a displacement (µm relative to the model's zero) that is wanted a tick after
// the voltage stands.
//
// # Safety
// `inverse` points to an initialised structure that nobody else uses, and `command` to a structure.
PiezoResult piezo_inverse_tick(struct PiezoInverse *inverse, float displacement_um, struct PiezoCommand *command);

// One tick towards the rest voltage, as fast as the limits allow: the way out of every mode, for it cannot jump.
//
// # Safety
// As `piezo_inverse_tick`.
PiezoResult piezo_inverse_release(struct PiezoInverse *inverse, struct PiezoCommand *command);

// Reads and checks a parameter table: the bytes of `table.bin`, with or without others behind them.
//
// `reason` takes what is wrong, in English, cut to `size` bytes with its final NUL, and "" where nothing is; it
// may be null.
//
// # Safety
// `record` points to `length` bytes, no more than a signed `ptrdiff_t` counts, `table` to a structure or is null, and
// `reason` to `size` bytes or is null, none of which are the record's.
PiezoResult piezo_table_read(const uint8_t *record,
                             size_t length,
                             struct PiezoTable *table,
                             uint8_t *reason,
                             size_t size);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PIEZO_ESTIMATOR_H */
