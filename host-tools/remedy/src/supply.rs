//! A device's supply, and below which its chip is reset.

use protocol::Health;

/// The reset thresholds of the levels, about, V (RM0440, "FLASH option register", BOR_LEV).
const THRESHOLDS_V: [f64; 5] = [1.7, 2.0, 2.2, 2.5, 2.8];

/// The supply as it was measured, and what its brown-out reset leaves open, with the remedy; `None` where the board
/// can tell neither.
pub fn supply(health: &Health) -> Option<String> {
    let measured = health.supply_mv.map(|millivolt| format!("{:.3} V", f64::from(millivolt) * 1e-3));
    let parts: Vec<String> = [measured, health.brown_out_level.map(brown_out)].into_iter().flatten().collect();
    (!parts.is_empty()).then(|| parts.join("; "))
}

fn brown_out(level: u8) -> String {
    let highest = THRESHOLDS_V.len() - 1;
    match THRESHOLDS_V.get(usize::from(level)) {
        None => format!("the brown-out reset is at a level that the chip's manual does not know, BOR_LEV = {level}"),
        Some(volt) if usize::from(level) == highest => format!("the chip is reset below about {volt:.1} V"),
        Some(volt) => format!(
            "the chip is reset below about {volt:.1} V only (BOR_LEV = {level})\n  → until then a supply that sags faster than \
             it is measured takes the output along; with the probe plugged in: STM32_Programmer_CLI -c port=SWD -ob \
             BOR_LEV={highest}, then pull the power ({:.1} V; this program and the firmware write no option bytes)",
            THRESHOLDS_V[highest]
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_level_says_its_voltage_and_those_that_are_too_low_what_to_type() {
        for (level, part, remedy) in [
            (0, "1.7 V only", true),
            (3, "2.5 V only", true),
            (4, "below about 2.8 V", false),
            (7, "BOR_LEV = 7", false),
        ] {
            let said = brown_out(level);
            assert!(said.contains(part) && said.contains("-ob BOR_LEV=4") == remedy, "{said}");
        }
    }
}
