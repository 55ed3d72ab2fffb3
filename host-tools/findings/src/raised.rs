//! What status bits say of the estimates of a log, in words.

use estimator_core::Status;
use identification::validate::Raised;

/// What status bits mean for the estimates of a log, each with how often it was raised, one after the other; empty
/// where none says anything of them.
pub fn remarks(raised: &[Raised]) -> String {
    let meanings = [
        (
            Status::VOLTAGE_OUT_OF_RANGE,
            "the voltage left the range the model was identified on; the nearest end was taken",
        ),
        (Status::CLAMPED, "the estimate was clamped to the table's limits"),
        (Status::DAC_SATURATED, "the displacement reached an end of the DAC's range"),
        (Status::ADC_SATURATED, "the ADC stood at an end of its range"),
        (
            Status::UNTRAINED,
            "the voltage went as it never did in the training, and what the estimate says there was not learnt",
        ),
        (Status::SLEW_EXCEEDED, "the voltage leapt as the amplifier cannot; the last one before was taken"),
    ];
    let said = meanings.into_iter().filter_map(|(bit, meaning)| {
        let Raised { percent, first_s, .. } = raised.iter().find(|raised| raised.bit == bit)?;
        Some(format!("{percent:.2} % of the time, first at {first_s:.3} s, {meaning}"))
    });
    said.collect::<Vec<_>>().join("; ")
}
