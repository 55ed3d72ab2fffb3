/* The estimator and its inverse, as a program for a Cortex-M uses them.
 *
 * Here the codes and the wishes are made up and what comes out is printed, so that it can be compared with the host's to
 * the last bit (tests/cortex_m/main.rs). In yours, begin() runs once after the start; on_tick() is the interrupt of a timer with
 * the table's sample period, in which the ADC has converted. */

#include "piezo_estimator.h"
#include "port.h"

enum { TICKS = 3000, TOLD_AT = 1500 };

static PiezoEstimator estimator;
static PiezoInverse inverse;

static bool begin(PiezoTable *facts) {
    char reason[200];
    const size_t length = (size_t)(port_table_end - port_table);
    if (piezo_table_read(port_table, length, facts, (uint8_t *)reason, sizeof reason) != PIEZO_RESULT_OK) {
        port_print(reason);
        return false;
    }
    if (piezo_estimator_begin(&estimator, port_table, length) != PIEZO_RESULT_OK) {
        return false;
    }
    const PiezoDriveLimits limits = {
        .voltage_min_v = facts->voltage_min_v,
        .voltage_max_v = facts->voltage_max_v,
        .rest_v = facts->voltage_min_v,
        .slew_v_per_s = 100.0f * (facts->voltage_max_v - facts->voltage_min_v),
    };
    /* Not every model has one; its ticks are refused then. */
    (void)piezo_inverse_begin(&inverse, port_table, length, &limits);
    return true;
}

static void on_tick(uint16_t code, float wanted_um) {
    PiezoEstimate estimate;
    if (piezo_estimator_tick(&estimator, code, &estimate) == PIEZO_RESULT_OK) {
        port_print_bits('E', estimate.displacement_um, estimate.half_width_um, estimate.dac_code, estimate.status);
    }
    PiezoCommand command;
    if (piezo_inverse_tick(&inverse, wanted_um, &command) == PIEZO_RESULT_OK) {
        port_print_bits('C', command.voltage_v, command.displacement_um, 0, command.reached);
    }
}

int main(void) {
    PiezoTable facts;
    if (!begin(&facts)) {
        return 1;
    }
    port_print_stack();
    uint32_t noise = 1;
    for (uint32_t tick = 0; tick < TICKS; tick++) {
        /* Triangles at first, then jumps. */
        noise = noise * 1664525u + 1013904223u;
        const uint32_t phase = tick % 800;
        const uint16_t triangle = (uint16_t)(160u * (phase < 400 ? phase : 800 - phase));
        const uint16_t code = tick < 2000 ? triangle : (uint16_t)(noise >> 16);
        const float span_um = facts.displacement_max_um - facts.displacement_min_um;
        on_tick(code, facts.displacement_min_um + span_um * ((float)code / 65536.0f));
        if (tick == TOLD_AT) {
            (void)piezo_estimator_set_zero(&estimator, 1.0f);
        }
    }
    return 0;
}
