//! `piezo info`: everything that a device says, in words.

use super::{json, piezo};
use emulator::faults::messages;
use emulator::{Emulator, FaultyLine};
use protocol::{Faults, Health, Reply, ToHost, text};

/// A device in front of which stands a line that tells another health.
fn device_of(health: impl Fn(Health) -> Health + Send + 'static) -> (emulator::EmulatedDevice, FaultyLine) {
    let device = Emulator::new().start().unwrap();
    let told = messages(move |message| match message {
        ToHost::Reply { to, reply: Reply::Health(of) } => Some(ToHost::Reply { to, reply: Reply::Health(health(of)) }),
        other => Some(other),
    });
    let line = FaultyLine::to(device.address(), told).unwrap();
    (device, line)
}

/// What is printed of it.
fn printed(line: &FaultyLine) -> String {
    let port = format!("tcp:{}", line.address());
    String::from_utf8(piezo().args(["info", "--port", &port]).assert().get_output().stdout.clone()).unwrap()
}

#[test]
fn everything_is_said_in_words() {
    let (_device, line) = device_of(|health| Health {
        faults: Faults::SAFE_OUTPUT,
        faults_seen: Faults::ADC_STUCK,
        last_words: Some(text("panicked at the disco")),
        cycles_last: 850,
        cycles_max: 1700,
        cycles_period: 85_000,
        voltage_out_of_range: 3,
        bias_um: -0.4125,
        bias_age_ticks: Some(24_000),
        supply_mv: Some(3298),
        brown_out_level: Some(0),
        ..health
    });
    let text = printed(&line);
    for part in [
        "Board    emulated",
        "from the firmware image, since no table is stored",
        "1.0 % of its time, at most 2.0 %",
        "zeroed 12 s ago, bias -0.412 µm",
        "Supply   3.298 V; the chip is reset below about 1.7 V only (BOR_LEV = 0)",
        "-ob BOR_LEV=4",
        "now: the DAC stands at its safe value",
        "earlier: the ADC gives one and the same code",
        "3 ticks: the voltage left the range",
        "panicked at the disco",
    ] {
        assert!(text.contains(part), "{part:?} is missing in\n{text}");
    }
    let port = format!("tcp:{}", line.address());
    let json = json(piezo().args(["info", "--json", "--port", &port]));
    assert_eq!(json["identity"]["source"]["Compiled"]["reason"], "no table is stored");
    assert_eq!(json["health"]["faults_seen"], serde_json::json!(["ADC_STUCK"]));
    assert_eq!(json["health"]["bias_age_ticks"], 24_000);
    assert_eq!(json["table"]["sample_period_us"], 500);
}

#[test]
fn a_bias_says_how_old_it_is() {
    for (ticks, says) in [
        (None, "never zeroed since the estimate began"),
        (Some(600_000), "zeroed 5 min ago, bias +0.412 µm"),
        (Some(18_000_000), "zeroed 2.5 h ago, bias +0.412 µm"),
        (Some(Health::OLDEST_BIAS_TICKS), "zeroed at least 596.5 h ago, bias +0.412 µm"),
    ] {
        let (_device, line) = device_of(move |health| Health { bias_um: 0.412, bias_age_ticks: ticks, ..health });
        let text = printed(&line);
        assert!(text.contains(says), "{says:?} is missing in\n{text}");
    }
}
