//! The parameter table and its record: what goes in comes out, and what is wrong is refused by its own name.

use crate::common::{VOIGT, any_table, resealed, table};
use estimator_core::record::{MAX_LENGTH, VERSION};
use estimator_core::*;
use proptest::prelude::*;

/// Where the record says which model it is: behind header, tick, scheme, deadband, zeros, voltages and displacements.
const MODEL: usize = 8 + 2 + 1 + 3 * 4 + 4 * 4;

fn encoded(table: Table) -> Vec<u8> {
    let mut buffer = [0; MAX_LENGTH];
    let length = table.admit().unwrap().encode(&mut buffer).unwrap();
    buffer[..length].to_vec()
}

#[test]
fn record_is_pinned() {
    let hex: String = encoded(table()).iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(
        hex,
        concat!(
            "505a5442",
            "0d00",
            "7a00", // magic, version, length
            "f403",
            "00",
            "00000000",
            "00000000",
            "00000000",
            // 500 µs, scheme, deadband, zeros
            "0000a0c1",
            "0000a041",
            "0000c0c0",
            "0000c040", // ±20 V, ±6 µm
            "00",       // Voigt
            "79698e44",
            "52703b44",
            "0ef8fc3b",
            "904cb147",
            "2506413f", // α, β, λ, b, P
            "00000000",
            "00000000",
            "00000000",
            "00000000", // g, h, e, f
            "00000000",
            "00000000", // remanence
            "010b303c",
            "0000b0c1",
            "00",
            "ff1f", // ADC
            "00",   // no slew rate of the amplifier
            "00009643",
            "00f0ff44",
            "ff1f", // DAC
            "00",   // no drive
            "00",   // no interval
            "a5a5a5a5a5a5a5a5",
            "07",
            "000100",
            "0000803e",
            "01b81e853e",
            "00",       // provenance
            "d2a0f98e", // CRC-32
        ),
        "the format changed: bump record::VERSION and say so in CHANGELOG.md"
    );
}

#[test]
fn each_fault_has_its_own_error() {
    let good = encoded(table());
    let need = good.len();
    for have in 0..need {
        let refused = Table::parse(&good[..have]).unwrap_err();
        let expected = if have < 8 { 8 } else { need };
        assert_eq!(refused, TableError::Truncated { need: expected, have });
    }
    assert_eq!(Table::parse(&[0xff; 2048]).unwrap_err(), TableError::NotATable);
    let mut other = good.clone();
    other[4] = VERSION as u8 + 1;
    assert_eq!(Table::parse(&resealed(other)).unwrap_err(), TableError::Version { found: VERSION + 1, read: VERSION });
    for byte in 8..need {
        let mut corrupt = good.clone();
        corrupt[byte] ^= 0x10;
        assert!(matches!(Table::parse(&corrupt), Err(TableError::Checksum { .. })), "byte {byte}");
    }
    let mut model = good.clone();
    model[MODEL] = Model::ALL.len() as u8;
    assert_eq!(Table::parse(&resealed(model)).unwrap_err(), TableError::Payload);
    let mut longer = good.clone();
    longer[6] += 1;
    longer.push(0);
    assert_eq!(Table::parse(&resealed(longer)).unwrap_err(), TableError::Payload);
    let mut erased_behind = good.clone();
    erased_behind.extend([0xff; 100]);
    assert_eq!(*Table::parse(&erased_behind).unwrap(), table());
}

#[test]
fn a_buffer_that_is_too_small_is_no_panic() {
    let admitted = table().admit().unwrap();
    let need = encoded(table()).len();
    for size in 0..need {
        assert_eq!(admitted.encode(&mut vec![0; size]), None);
    }
    assert_eq!(admitted.encode(&mut vec![0; need]), Some(need));
}

#[test]
fn inadmissible_sets_are_refused() {
    let with = |parameters| Table { parameters: Parameters::Voigt(parameters), ..table() }.admit().unwrap_err();
    let fast = VoigtParameters { b_ohm: VOIGT.b_ohm / 10.0, ..VOIGT };
    assert!(matches!(with(fast), TableError::Inadmissible(Inadmissible::Unstable { a, .. }) if a < 0.0));
    let frozen = VoigtParameters { alpha_um: 1e12, ..VOIGT };
    assert!(matches!(with(frozen), TableError::Inadmissible(Inadmissible::Unstable { a, .. }) if a == 1.0));
    let large = VoigtParameters { p: 0.7, ..VOIGT };
    assert!(matches!(with(large), TableError::Inadmissible(Inadmissible::Unbounded { reach, .. }) if reach.max > 6.0));
    let tight = Table { displacement_limits_um: Range { min: -6.0, max: 3.0 }, ..table() };
    let refused = tight.admit().unwrap_err();
    assert!(matches!(refused, TableError::Inadmissible(Inadmissible::Unbounded { reach, .. }) if reach.max > 4.0));
    assert_eq!(
        with(VoigtParameters { p: 8.0, b_ohm: 1e-7, alpha_um: 1e18, ..VOIGT }),
        TableError::Inadmissible(Inadmissible::Overflow)
    );
    // Exact over a tick of any length, so the rate that Euler cannot follow is admitted.
    let exact = Table { parameters: Parameters::Voigt(fast), scheme: Scheme::ZeroOrderHold, ..table() };
    let wide = Table { displacement_limits_um: Range { min: -60.0, max: 60.0 }, ..exact };
    assert!(wide.admit().is_ok(), "{:?}", wide.admit());
    // So fast that nothing of the displacement is left after a tick.
    let instant = VoigtParameters { alpha_um: VOIGT.alpha_um / 300.0, ..VOIGT };
    assert!(
        Table { parameters: Parameters::Voigt(instant), ..wide }.admit().is_ok(),
        "{:?}",
        Table { parameters: Parameters::Voigt(instant), ..wide }.admit()
    );
    // So slow that an f32 near 1 cannot tell what a tick takes away.
    let slow = VoigtParameters { alpha_um: 2000.0 * VOIGT.alpha_um, ..VOIGT };
    assert!(matches!(with(slow), TableError::Inadmissible(Inadmissible::Unstable { a, .. }) if a < 1.0));
}

#[test]
fn numbers_out_of_range_are_refused_by_name() {
    let cases: [(Table, &str); 20] = [
        (Table { sample_period_us: 0, ..table() }, "sample_period_us"),
        (Table { deadband_v: 41.0, ..table() }, "deadband_v"),
        (Table { voltage_range_v: Range { min: 1.0, max: 1.0 }, ..table() }, "voltage_range_v"),
        // The interval counts voltages in half ranges.
        (Table { voltage_range_v: Range { min: 1e-38, max: 2e-38 }, deadband_v: 0.0, ..table() }, "a microvolt wide"),
        (Table { displacement_limits_um: Range { min: -2e6, max: 1.0 }, ..table() }, "displacement_limits_um"),
        (Table { voltage_range_v: Range { min: -1.0, max: 2e5 }, ..table() }, "100 kV"),
        (Table { parameters: Parameters::Voigt(VoigtParameters { p: 9.0, ..VOIGT }), ..table() }, "p must"),
        (Table { parameters: Parameters::Voigt(VoigtParameters { f: 1.0, ..VOIGT }), ..table() }, "e_m_per_s and f"),
        (Table { dac: DacCalibration { full_scale: 0, ..table().dac }, ..table() }, "dac.full_scale"),
        (Table { parameters: Parameters::Voigt(VoigtParameters { b_ohm: -1.0, ..VOIGT }), ..table() }, "b_ohm"),
        (
            Table { parameters: Parameters::Voigt(VoigtParameters { g_um_per_s: 1.0, ..VOIGT }), ..table() },
            "g_um_per_s",
        ),
        (Table { adc: AdcCalibration { gain_v_per_code: 0.0, ..table().adc }, ..table() }, "adc.gain_v_per_code"),
        (Table { dac: DacCalibration { gain_codes_per_um: 0.0, ..table().dac }, ..table() }, "dac.gain_codes_per_um"),
        // So small that every code is one voltage in an f32, or every displacement one code.
        (Table { adc: AdcCalibration { gain_v_per_code: 1e-45, ..table().adc }, ..table() }, "two codes apart"),
        (
            Table { adc: AdcCalibration { gain_v_per_code: 8e-13, offset_v: -84.0, ..table().adc }, ..table() },
            "two codes apart",
        ),
        (Table { dac: DacCalibration { gain_codes_per_um: 1e-45, ..table().dac }, ..table() }, "a code wide"),
        (Table { amplifier_slew_v_per_s: Some(0.0), ..table() }, "amplifier_slew_v_per_s must be positive"),
        (Table { amplifier_slew_v_per_s: Some(-500.0), ..table() }, "amplifier_slew_v_per_s must be positive"),
        (Table { dac: DacCalibration { offset_code: 1e14, ..table().dac }, ..table() }, "offset_code"),
        (Table { dac: DacCalibration { offset_code: -2e6, ..table().dac }, ..table() }, "offset_code"),
    ];
    for (wrong, name) in cases {
        match wrong.admit() {
            Err(TableError::OutOfRange { rule }) => assert!(rule.contains(name), "{rule}"),
            other => panic!("{name}: {other:?}"),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    #[test]
    fn what_is_encoded_is_parsed(table in any_table()) {
        if let Ok(admitted) = table.admit() {
            let mut buffer = [0; MAX_LENGTH];
            let length = admitted.encode(&mut buffer).unwrap();
            prop_assert_eq!(Table::parse(&buffer[..length]).unwrap(), admitted);
        }
    }

    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(Table::parse(&bytes).is_err());
    }

    /// Corruption behind a right checksum: whatever parses is admissible and finite, the rest is refused.
    #[test]
    fn no_payload_panics(flips in prop::collection::vec((8usize..128, any::<u8>()), 1..8), cut in 0usize..40) {
        let mut record = encoded(table());
        for (at, bits) in flips {
            if let Some(byte) = record.get_mut(at) {
                *byte ^= bits;
            }
        }
        if cut < 4 {
            record.truncate(record.len() - cut);
            let payload = (record.len() - 12) as u16;
            record[6..8].copy_from_slice(&payload.to_le_bytes());
        }
        if let Ok(admitted) = Table::parse(&resealed(record)) {
            prop_assert!(admitted.admit().is_ok());
        }
    }

    /// Any one number made NaN or infinite is refused, by its name.
    #[test]
    fn non_finite_numbers_are_refused(which in 0usize..10, bad in prop_oneof![Just(f32::NAN), Just(f32::INFINITY)]) {
        let mut wrong = table();
        let mut voigt = VOIGT;
        let (slot, name) = match which {
            0 => (&mut voigt.alpha_um, "alpha_um"),
            1 => (&mut voigt.f, "f must"),
            8 => (&mut voigt.beta_v, "beta_v"),
            9 => (wrong.amplifier_slew_v_per_s.insert(0.0), "amplifier_slew_v_per_s"),
            2 => (&mut wrong.deadband_v, "deadband_v"),
            3 => (&mut wrong.voltage_zero_v, "voltage_zero_v"),
            4 => (&mut wrong.displacement_limits_um.max, "displacement_limits_um"),
            5 => (&mut wrong.adc.offset_v, "adc.offset_v"),
            6 => (&mut wrong.dac.offset_code, "dac.offset_code"),
            _ => (&mut wrong.provenance.train_mae_um, "train_mae_um"),
        };
        *slot = bad;
        wrong.parameters = Parameters::Voigt(voigt);
        let refused = wrong.admit().unwrap_err().to_string();
        prop_assert!(refused.starts_with(name), "{refused}");
    }
}
