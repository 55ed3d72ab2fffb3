//! Board files that are read, and what is said of those that are not.

use super::*;
use crate::tests::FACTS;

fn read(text: &str) -> Result<BoardFacts, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("board.toml");
    std::fs::write(&path, text).unwrap();
    BoardFacts::read(&path).map_err(|error| error.to_string())
}

#[test]
fn what_is_written_is_read_and_what_is_left_out_is_not_known() {
    assert_eq!(read(&FACTS.to_toml()), Ok(FACTS));
    assert_eq!(read(""), Ok(BoardFacts::default()));
}

#[test]
fn what_cannot_be_is_named_with_its_place_or_value() {
    let says = |text: &str, parts: &[&str]| {
        let said = read(text).unwrap_err();
        assert!(parts.iter().all(|part| said.contains(part)) && said.contains("board.toml"), "{said}");
    };
    says("adc_spam = [0, 1]", &["line 1", "adc_spam", "adc_span"]);
    says("drive_rest = 1\ndrive_slew = 'fast'", &["line 2", "drive_slew = 'fast'"]);
    says("adc_span = [1.0, 1.0]", &["adc_span = [1, 1]", "differ"]);
    says("sensor_span = [nan, 1.0]", &["sensor_span"]);
    says("drive_slew = -5", &["drive_slew = -5", "positive"]);
    says("amplifier_slew = 0", &["amplifier_slew = 0", "positive"]);
    says("drive_range = [0, 200]\ndrive_span = [-30, 130]", &["drive_range = [0, 200]", "within drive_span"]);
    says("drive_range = [0, 90]\nadc_span = [0, 80]", &["drive_range = [0, 90]", "within adc_span"]);
    says("drive_range = [10, 90]\ndrive_rest = 0", &["drive_rest = 0", "within drive_range"]);
    says("drive_range = [0, 79.5]\nadc_span = [-10, 80]", &["line 1", "drive_range = [0, 79.5]", "saturated"]);
    let whole = "drive_span = [-30, 130]\ndrive_range = [0, 100]\ndrive_slew = 500\n";
    assert!(read(whole).is_ok());
    for line in whole.lines() {
        says(&whole.replace(line, "# none"), &["line ", "drive_", "belong together"]);
    }
    says(&format!("{whole}amplifier_slew = 400"), &["line 3: drive_slew = 500", "no more than amplifier_slew"]);
    says("# of the amplifier\ndrive_rest = 0", &["line 2: drive_rest = 0", "belong together"]);
    says("setpoint_span = [0, 40]", &["setpoint_span = [0, 40]", "drive_span"]);
    says(&format!("{whole}linearise = true"), &["line 4: linearise = true", "needs setpoint_span"]);
    says(&format!("{whole}setpoint_span = [4, 4]"), &["line 4: setpoint_span = [4, 4]", "differ"]);
    let controlled = BoardFacts { setpoint_span: Some((-1.0, 16.0)), linearise: Some(true), ..FACTS };
    assert_eq!(read(&controlled.to_toml()), Ok(controlled));
    for span in ["[-5,0, 25,0]", "[-5.0]", "[]", "[0, 1, 2]"] {
        says(
            &format!("drive_rest = 1\nsensor_span = {span}"),
            &["line 2", span, "two numbers, as [-5.0, 25.0], not", "with a point"],
        );
    }
    says("dac_full_scale = 0", &["dac_full_scale = 0"]);
    says("adc_full_scale = 70000", &["line 1", "70000"]);
}

#[test]
fn no_voltage_is_allowed_that_nobody_stated() {
    assert_eq!(
        read("adc_span = [-35, 135]").unwrap().range_v(),
        None,
        "what the ADC reads may be more than the actuator stands"
    );
    let of = |drive_range| BoardFacts { drive_range, ..FACTS }.range_v();
    assert_eq!(of(Some((100.0, 0.0))), Some(Range { min: 0.0, max: 100.0 }));
    assert_eq!(of(None), None);
}

#[test]
fn it_is_of_the_board_that_it_names_or_of_any() {
    let (one, other) = (Uid([1; 12]), Uid([2; 12]));
    let refused = |file: Option<Uid>, board: Option<Uid>| {
        let facts = BoardFacts { board_uid: file, ..FACTS };
        assert_eq!(read(&facts.to_toml()), Ok(facts));
        facts.of_board_uid(board).is_err()
    };
    assert!(!refused(Some(one), Some(one)) && !refused(None, Some(one)) && !refused(None, None));
    assert!(refused(Some(one), Some(other)) && refused(Some(one), None));
    let says = read("board_uid = \"12\"").unwrap_err();
    assert!(says.contains("24 hexadecimal digits"), "{says}");
}

#[test]
fn what_is_stated_wins_over_the_file() {
    let stated = CalibrationOptions { adc_span: Some(Span { zero: 1.0, full: 2.0 }), ..Default::default() };
    let both = FACTS.calibration(&stated);
    assert_eq!(both.adc_span, Some(Span { zero: 1.0, full: 2.0 }));
    assert_eq!((both.drive.drive_slew, both.amplifier_slew), (FACTS.drive_slew, FACTS.amplifier_slew));
    let faster = CalibrationOptions { amplifier_slew: Some(5e4), ..Default::default() };
    assert_eq!(FACTS.calibration(&faster).amplifier_slew, Some(5e4));
    let shows = CalibrationOptions { dac_span: Some(Span { zero: 0.0, full: 2.0 }), ..Default::default() };
    assert_eq!(FACTS.calibration(&shows).drive.drive_span, None);
}
