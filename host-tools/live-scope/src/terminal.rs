//! The last second as a terminal, or a program behind a pipe, is told it.

use device_link::window::Window;
use device_link::words;
use estimator_core::Range;
use protocol::{Faults, Mode};
use serde_json::json;

/// Characters of the bar.
const BAR: usize = 50;

/// The last second in a line; `received` and `lost` are its samples, `drives` is the mode of a device that
/// drives the amplifier.
pub fn line(window: &Window, drives: Option<Mode>, received: u64, lost: u64) -> String {
    let (Some(y), Some(v), Some(code)) = (window.displacement(), window.voltage(), window.code()) else {
        return format!("no samples; {lost} lost");
    };
    format!(
        "{:9.3} µm{} ({:.3} … {:.3})  {:8.4} V ({:.4} … {:.4})  code {code:5}  {received} samples{}, {lost} lost{}",
        y.last,
        beside(window),
        y.min,
        y.max,
        v.last,
        v.min,
        v.max,
        part(window),
        said(window, drives).map_or(String::new(), |said| format!("  {said}"))
    )
}

/// Which ticks the samples are of, where they are not of all.
fn part(window: &Window) -> String {
    match window.every().get() {
        1 => String::new(),
        every => format!(" (one of {every} ticks)"),
    }
}

/// The interval beside the estimate, if there is one.
fn beside(window: &Window) -> String {
    window.half_width().map_or(String::new(), |half| format!(" ± {half:.3} µm"))
}

/// The last second as a JSON object; `samples` and `lost` are its samples.
pub fn object(window: &Window, time_s: f64, samples: u64, lost: u64) -> String {
    let (y, v) = (window.displacement(), window.voltage());
    json!({
        "time_s": time_s,
        "displacement_um": y.map(|y| y.last),
        "half_width_um": window.half_width(),
        "displacement_min_um": y.map(|y| y.min),
        "displacement_max_um": y.map(|y| y.max),
        "voltage_V": v.map(|v| v.last),
        "voltage_min_V": v.map(|v| v.min),
        "voltage_max_V": v.map(|v| v.max),
        "code": window.code(),
        "samples": samples,
        "lost": lost,
        "every": window.every(),
        "status": window.status().iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
        "faults": window.faults().iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
    })
    .to_string()
}

/// Status and faults of the last second in words, if there are any; a rest is no fault.
fn said(window: &Window, drives: Option<Mode>) -> Option<String> {
    let rests = drives.is_some_and(|mode| words::rests(mode, window.faults()));
    let faults = if rests { Faults::empty() } else { window.faults() };
    let rest = rests.then_some(words::AT_REST);
    let faults = words::faults(faults).map(|(_, what)| what).chain(rest);
    let words = words::list(faults.chain(words::status(window.status()).map(|(_, what)| what)));
    (!words.is_empty()).then_some(words)
}

/// The last second as lines for people, with the mode of a device that drives the amplifier, the table's limits and the
/// samples that come in a second.
pub fn picture(window: &Window, drives: Option<Mode>, limits: Range, rate: Option<f64>) -> Vec<String> {
    let (Some(y), Some(v), Some(code)) = (window.displacement(), window.voltage(), window.code()) else {
        return vec!["waiting for samples …".to_owned(), "Ctrl-C ends".to_owned()];
    };
    let rate = rate.map_or("…".to_owned(), |rate| format!("{rate:.0}"));
    vec![
        format!("displacement {:10.3} µm{}   last second {:.3} … {:.3} µm", y.last, beside(window), y.min, y.max),
        format!("voltage      {:10.4} V    last second {:.4} … {:.4} V   ADC code {code}", v.last, v.min, v.max),
        format!("{:.1} {} {:.1} µm", limits.min, bar(y.last, limits), limits.max),
        format!("{rate} samples a second{}, {} lost", part(window), window.lost()),
        said(window, drives).unwrap_or("all is well".to_owned()),
        "Ctrl-C ends".to_owned(),
    ]
}

/// Where a value stands within limits.
fn bar(value: f32, limits: Range) -> String {
    let part = ((value - limits.min) / (limits.max - limits.min)).clamp(0.0, 1.0);
    // Of a NaN this is 0.
    let place = (part * (BAR - 1) as f32).round() as usize;
    (0..BAR).map(|k| if k == place { '█' } else { '·' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use device_link::Client;
    use emulator::faults::lose_samples_at;
    use emulator::{Emulator, FaultyLine, TABLE};
    use estimator_core::{AdcCode, DacCode, Status};
    use protocol::{Sample, Samples};
    use std::num::NonZeroU8;
    use std::time::{Duration, Instant};

    const LIMITS: Range = Range { min: -5.0, max: 45.0 };

    #[test]
    fn the_bar_shows_where_it_is_and_never_leaves_itself() {
        let place = |value| bar(value, LIMITS).chars().position(|c| c == '█');
        assert_eq!((place(-5.0), place(45.0), place(-1e9), place(f32::NAN)), (Some(0), Some(49), Some(0), Some(0)));
        assert_eq!(bar(20.0, LIMITS).chars().count(), BAR);
    }

    #[test]
    fn a_rest_is_said_to_be_one_where_the_device_drives_and_nothing_else_is_wrong() {
        let of = |faults: Faults, drives| {
            let (status, half_width) = (Status::empty(), None);
            let sample = Sample { code: 3, sensor: None, displacement: 1.0, half_width, dac: 0, status, faults };
            let mut window = Window::new(TABLE.adc, 2000);
            window.take(&Samples { first: 0, every: NonZeroU8::MIN, samples: [sample].into_iter().collect() });
            (line(&window, drives, 1, 0), picture(&window, drives, LIMITS, None).join("\n"))
        };
        let (line, picture) = of(Faults::SAFE_OUTPUT, Some(Mode::Estimate));
        assert!(line.contains(words::AT_REST) && picture.contains(words::AT_REST), "{line}\n{picture}");
        assert!(!line.contains("safe value") && !picture.contains("safe value"), "{line}\n{picture}");
        let wrong = [
            (Faults::SAFE_OUTPUT, None),
            (Faults::SAFE_OUTPUT, Some(Mode::Linearise)),
            (Faults::SAFE_OUTPUT | Faults::AMPLIFIER, Some(Mode::Estimate)),
        ];
        for (faults, drives) in wrong {
            assert!(of(faults, drives).0.contains("the DAC stands at its safe value"), "{faults:?} {drives:?}");
        }
    }

    #[test]
    fn a_second_of_samples_in_figures_and_words() {
        // A saw over a quarter of the range.
        let mut tick = 0;
        let saw = move |_: DacCode| {
            tick = (tick + 1) % 1000;
            AdcCode(24_000 + 16 * tick).into()
        };
        let device = Emulator::new().plant(saw).speed(8.0).start().unwrap();
        let faulty = FaultyLine::to(device.address(), lose_samples_at(100)).unwrap();
        let (mut client, _) = Client::connect(&faulty.address().into()).unwrap();
        client.stream(true).unwrap();
        let mut window = Window::new(TABLE.adc, 2000);
        assert!(picture(&window, None, LIMITS, None)[0].contains("waiting"));
        assert_eq!(line(&window, None, 0, 0), "no samples; 0 lost");
        let until = Instant::now() + Duration::from_secs(10);
        while (window.received() < 200 || window.lost() == 0) && Instant::now() < until {
            client.samples(Duration::from_millis(100)).unwrap().iter().for_each(|samples| window.take(samples));
        }
        assert!(window.received() > 100 && window.lost() > 0);
        let object: serde_json::Value = serde_json::from_str(&object(&window, 1.0, 7, 8)).unwrap();
        assert!(object["displacement_um"].is_number() && object["voltage_V"].is_number(), "{object}");
        assert_eq!((&object["samples"], &object["lost"]), (&json!(7), &json!(8)));
        let picture = picture(&window, None, LIMITS, Some(1999.7)).join("\n");
        for part in ["µm", " V ", "█", "2000 samples a second", "had not turned at either end"] {
            assert!(picture.contains(part), "{part:?} is missing in\n{picture}");
        }
    }
}
