//! A table's record of any content: refused, or an estimator and an inverse that nothing which comes in makes
//! leave their limits.

use arbitrary::{Arbitrary, Unstructured};
use estimator_core::sealed::seal;
use estimator_core::{AdcCode, Admitted, DriveLimits, Estimate, Estimator, Inverse, Range, Table};

/// Most ticks of an input; more of them would only make it slow.
const TICKS: usize = 1_000;

/// What happens to a running estimator.
#[derive(Debug, Arbitrary)]
enum Event {
    Code(u16),
    /// As many ticks at a code, or at it and its neighbour in turn.
    Dwell {
        code: u16,
        ticks: u8,
        ripples: bool,
    },
    /// Any number there is, NaN and the infinities among them.
    Volts(f32),
    SetZero(f32),
    Shift(f32),
    StartAt(f32),
    Restart,
    Tell,
    Wish(f32),
    Steer(f32),
    Release,
}

/// Bytes as a record, and as the payload of one with the right header and checksum; what follows the payload is what
/// happens to the estimator.
///
/// # Panics
/// A promise is broken.
pub fn check(bytes: &[u8]) {
    // Nearly always refused, by its first bytes or its checksum.
    if let Ok(table) = Table::parse(bytes) {
        same(&table);
    }
    let Some((admitted, rest)) = admitted(bytes) else { return };
    same(&admitted);
    run(&admitted, rest);
}

/// The admitted table that the payload of a record at the start of some bytes makes, and what follows it.
///
/// # Panics
/// A record with this payload is read as something else.
pub fn admitted(bytes: &[u8]) -> Option<(Admitted, &[u8])> {
    let (table, rest) = postcard::take_from_bytes::<Table>(bytes).ok()?;
    let payload = &bytes[..bytes.len() - rest.len()];
    let mut record = [b"PZTB", &estimator_core::record::VERSION.to_le_bytes()[..]].concat();
    // No list of a table has more than a few hundred numbers.
    record.extend(u16::try_from(payload.len()).expect("a payload is short").to_le_bytes());
    record.extend(payload);
    let end = record.len();
    record.extend([0; 4]);
    seal(&mut record, end).expect("there is room for the checksum");
    let read = Table::parse(&record);
    let Ok(admitted) = table.admit() else {
        assert!(read.is_err(), "a record is admitted whose table is not");
        return None;
    };
    assert_eq!(read, Ok(admitted), "a record is read as another table");
    Some((admitted, rest))
}

/// A table's record is read as that table.
fn same(table: &Admitted) {
    let mut record = [0; estimator_core::record::MAX_LENGTH];
    let length = table.encode(&mut record).expect("MAX_LENGTH suffices for every table");
    assert_eq!(Table::parse(&record[..length]), Ok(*table), "a record is read as another table");
}

fn run(table: &Admitted, bytes: &[u8]) {
    let mut estimator = Estimator::<f32>::new(table);
    let limits = table.drive.map_or_else(|| whole(table), |drive| drive.limits);
    let mut inverse = table.inverse::<f32>(&limits).ok().map(|inverse| Driven { inverse, limits });
    let mut events = Unstructured::new(bytes);
    let mut ticks = 0;
    while ticks < TICKS && !events.is_empty() {
        let Ok(event) = Event::arbitrary(&mut events) else { return };
        ticks += 1;
        match event {
            Event::Code(code) => sound(table, &mut estimator, |estimator| estimator.tick(AdcCode(code))),
            Event::Dwell { code, ticks: dwell, ripples } => {
                for k in 0..dwell {
                    let code = AdcCode(code ^ u16::from(ripples && k % 2 == 1));
                    sound(table, &mut estimator, |estimator| estimator.tick(code));
                }
                ticks += usize::from(dwell);
            }
            Event::Volts(volts) => sound(table, &mut estimator, |estimator| estimator.tick_volts(volts)),
            Event::SetZero(at) => told(&mut estimator, at, Estimator::set_zero),
            Event::Shift(by) => told(&mut estimator, by, Estimator::shift),
            Event::StartAt(displacement) => {
                let within = table.displacement_limits_um.contains(displacement);
                assert_eq!(estimator.start_at(displacement), within);
            }
            Event::Restart => estimator.restart(),
            Event::Tell => assert!(!estimator.tell() || table.interval.is_some()),
            Event::Wish(um) => inverse.iter_mut().for_each(|driven| driven.wish(um)),
            Event::Steer(volts) => {
                inverse.iter_mut().for_each(|driven| driven.go(|inverse| inverse.steer(volts).voltage))
            }
            Event::Release => inverse.iter_mut().for_each(|driven| driven.go(|inverse| inverse.release().voltage)),
        }
    }
}

/// The whole of a table's voltages, in about a hundred ticks.
fn whole(table: &Admitted) -> DriveLimits {
    let Range { min, max } = table.voltage_range_v;
    let range_v = Range { min: min + table.voltage_zero_v, max: max + table.voltage_zero_v };
    let second = 1e6 / table.sample_period_us as f32;
    DriveLimits { range_v, rest_v: range_v.min, slew_v_per_s: table.voltage_range_v.span() * second / 100.0 }
}

/// A tick's estimate is finite and within the limits, plus the bias, whatever came in.
fn sound(table: &Admitted, estimator: &mut Estimator<f32>, tick: impl FnOnce(&mut Estimator<f32>) -> Estimate<f32>) {
    let Estimate { displacement, half_width, dac, .. } = tick(estimator);
    let (Range { min, max }, bias) = (table.displacement_limits_um, estimator.bias());
    let within = Range { min: min + bias, max: max + bias };
    assert!(displacement.is_finite() && within.contains(displacement), "{displacement} µm is not within {within:?}");
    assert!(dac.0 <= table.dac.full_scale);
    assert!(half_width.is_none_or(|half| half.is_finite() && half >= 0.0), "{half_width:?}");
}

/// A bias is taken where it is finite only.
fn told(estimator: &mut Estimator<f32>, um: f32, tell: impl FnOnce(&mut Estimator<f32>, f32) -> bool) {
    let (before, may) = (estimator.bias(), estimator.may_be_told());
    let taken = tell(estimator, um);
    assert!(estimator.bias().is_finite() && (may || !taken) && (um.is_finite() || !taken));
    assert!(taken || estimator.bias() == before, "what was not taken has changed the bias");
}

/// An inverse, and what it must keep to.
struct Driven {
    inverse: Inverse<f32>,
    limits: DriveLimits,
}

impl Driven {
    fn wish(&mut self, um: f32) {
        self.go(|inverse| {
            let commanded = inverse.tick(um);
            assert!(!commanded.reached || um.is_finite());
            assert!(commanded.displacement.is_finite());
            commanded.voltage
        });
    }

    fn go(&mut self, tick: impl FnOnce(&mut Inverse<f32>) -> f32) {
        let voltage = tick(&mut self.inverse);
        let Range { min, max } = self.limits.range_v;
        // The zero is taken away and added again.
        let rounding = 8.0 * f32::EPSILON * (min.abs().max(max.abs()));
        let range = Range { min: min - rounding, max: max + rounding };
        assert!(range.contains(voltage), "{voltage} V is not within {range:?}");
    }
}
