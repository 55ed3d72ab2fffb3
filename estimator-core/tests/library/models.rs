//! What must hold of a table of any model: its record's length, no panic on any bytes, no displacement
//! beyond the limits.

use crate::common::interval;
use crate::common::models::table_of;
use crate::common::resealed;
use estimator_core::record::MAX_LENGTH;
use estimator_core::*;
use proptest::prelude::*;

fn encoded(table: &Admitted) -> Vec<u8> {
    let mut buffer = [0; MAX_LENGTH];
    let length = table.encode(&mut buffer).expect("MAX_LENGTH suffices");
    buffer[..length].to_vec()
}

#[test]
fn the_longest_record_of_every_model_fits_and_comes_back() {
    let mut longest = 0;
    for model in Model::ALL {
        let longest_provenance = Provenance {
            seed: u32::MAX,
            tool_version: [u16::MAX; 3],
            validation_mae_um: Some(1.0),
            validation_max_um: Some(1.0),
            ..table_of(model).provenance
        };
        let converters = |table: Table| Table {
            sample_period_us: 1_000_000,
            adc: AdcCalibration { full_scale: u16::MAX, ..table.adc },
            dac: DacCalibration { full_scale: u16::MAX, ..table.dac },
            interval: Some(interval()),
            provenance: longest_provenance,
            ..table
        };
        // The longest tick does not suit every model; a record's length does not depend on what its numbers are.
        let mut payload = [0; 2 * MAX_LENGTH];
        longest = longest.max(postcard::to_slice(&converters(table_of(model)), &mut payload).unwrap().len() + 12);
        let table = table_of(model).admit().unwrap_or_else(|error| panic!("{model}: {error}"));
        assert_eq!(Table::parse(&encoded(&table)), Ok(table), "{model}");
    }
    assert!(longest <= MAX_LENGTH, "{longest}");
    assert!(longest > MAX_LENGTH - 32, "MAX_LENGTH is larger than needed: {longest}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2048))]

    /// Corruption behind a right checksum: what parses runs on whatever codes come, and stays within its limits.
    #[test]
    fn no_payload_of_any_model_panics(
        model in prop::sample::select(Model::ALL.to_vec()),
        flips in prop::collection::vec((8usize..MAX_LENGTH, any::<u8>()), 0..6),
        codes in prop::collection::vec(prop_oneof![Just(0u16), Just(u16::MAX), any::<u16>(), 0u16..4096], 1..60),
        references in prop::collection::vec(prop_oneof![Just(f32::NAN), any::<f32>(), -20f32..40.0], 1..20),
    ) {
        let table = Table { interval: Some(interval()), ..table_of(model) };
        let mut record = encoded(&table.admit().unwrap());
        for (at, bits) in flips {
            if let Some(byte) = record.get_mut(at) {
                *byte ^= bits;
            }
        }
        if let Ok(table) = Table::parse(&resealed(record)) {
            let mut estimator = Estimator::<f32>::new(&table);
            for code in codes {
                let displacement = estimator.tick(AdcCode(code)).displacement;
                prop_assert!(table.displacement_limits_um.contains(displacement), "{displacement}");
            }
            if let Some(drive) = &table.drive {
                let mut inverse = table.inverse::<f32>(&drive.limits).unwrap();
                for reference in references {
                    let voltage = inverse.tick(reference).voltage;
                    let Range { min, max } = drive.limits.range_v;
                    let rounding = 1e-5 * (max.abs() + min.abs() + table.voltage_zero_v.abs());
                    prop_assert!(min - rounding <= voltage && voltage <= max + rounding, "{voltage}");
                }
            }
        }
    }
}
