//! The models' places against two descriptions that others made: the SVD file of ST as stm32-rs has mended it (the
//! crate `stm32g4`), and embassy's, made of ST's headers (`stm32-metapac`). Compared are where each peripheral and each
//! register begins, each field's bits, the numbers of the interrupts and of the requests for DMA. Of the core's own
//! registers it is their addresses, with the crate `cortex-m`: it has no bits of theirs.

mod core_registers;
mod metapac;
mod svd;

use std::collections::BTreeMap;

use crate::{
    adc, bases, clock, dac, dma, flash, gpio, layout::Peripheral, nvic::exception, rcc, timer, uart, watchdog,
};

/// What a description has, by its own names in capital letters.
#[derive(Default)]
struct Description {
    /// What it is called in a failure.
    name: &'static str,
    /// Peripherals and their addresses.
    bases: BTreeMap<String, u32>,
    /// `PERIPHERAL.REGISTER` and its offset.
    registers: BTreeMap<String, u32>,
    /// `PERIPHERAL.REGISTER.FIELD` and its mask.
    fields: BTreeMap<String, u32>,
    /// `INTERRUPT.` with its name, and its number.
    interrupts: BTreeMap<String, u32>,
    /// What it calls otherwise than the manual: peripherals, and of each a register or a register's field.
    spelling: &'static [(&'static str, &'static [(&'static str, &'static str)])],
    /// What it does not have.
    absent: &'static [&'static str],
    /// Where it is wrong, or speaks of something else, and what it says there.
    differs: &'static [(&'static str, u32)],
}

impl Description {
    /// The manual's name of a peripheral, a register or a field, as this description has it.
    fn spelled(&self, manual: &str) -> String {
        let (peripheral, place) = manual.split_once('.').unwrap_or((manual, ""));
        let own = |of: &str, name: &str| {
            let list = self.spelling.iter().find(|(peripheral, _)| *peripheral == of).map_or(&[][..], |(_, list)| list);
            list.iter().find(|(manual, _)| *manual == name).map(|(_, own)| *own)
        };
        let named = own("", peripheral).unwrap_or(peripheral);
        let of = SAME.iter().find(|(_, other)| *other == peripheral).map_or(peripheral, |(model, _)| model);
        let register = place.split('.').next().unwrap_or_default();
        match (own(of, place), own(of, register)) {
            _ if place.is_empty() => named.to_owned(),
            (Some(own), _) => format!("{named}.{own}"),
            (None, Some(own)) => format!("{named}.{own}{}", &place[register.len()..]),
            (None, None) => format!("{named}.{place}"),
        }
    }

    /// What is wrong with a place that a model has.
    fn against(&self, place: &str, model: u32, described: &BTreeMap<String, u32>) -> Option<String> {
        let (name, absent) = (self.name, self.absent.contains(&place));
        let expected = self.differs.iter().find(|(differs, _)| *differs == place).map_or(model, |(_, value)| *value);
        match described.get(&self.spelled(place)) {
            Some(_) if absent => Some(format!("{place}: {name} has it after all")),
            Some(&other) if other == expected => None,
            Some(other) => Some(format!("{place}: {model:#x} in the model, {other:#x} in {name}")),
            None if absent => None,
            None => Some(format!("{place}: {name} has none, looked for as {}", self.spelled(place))),
        }
    }
}

/// What the models declare.
const LAYOUTS: [&[Peripheral]; 10] = [
    adc::LAYOUT,
    clock::LAYOUT,
    dac::LAYOUT,
    dma::LAYOUT,
    flash::LAYOUT,
    gpio::LAYOUT,
    rcc::LAYOUT,
    timer::LAYOUT,
    uart::LAYOUT,
    watchdog::LAYOUT,
];
/// Peripherals that the same model stands for; basic timers have no compares (CC…).
const SAME: [(&str, &str); 4] = [("GPIOA", "GPIOB"), ("GPIOA", "GPIOC"), ("TIM5", "TIM6"), ("TIM5", "TIM7")];
const BASIC: [&str; 2] = ["TIM6", "TIM7"];

/// Interrupts as the manual calls them.
const INTERRUPTS: [(&str, u8); 8] = [
    ("FLASH", exception::FLASH),
    ("DMA1_CH1", exception::DMA1_CHANNEL1),
    ("DMA1_CH2", exception::DMA1_CHANNEL2),
    ("DMA1_CH3", exception::DMA1_CHANNEL3),
    ("ADC1_2", exception::ADC1_2),
    ("TIM5", exception::TIM5),
    ("TIM6_DAC", exception::TIM6),
    ("LPUART1", exception::LPUART1),
];

/// The models' sources.
const SOURCES: [(&str, &str); 12] = [
    ("adc.rs", include_str!("../adc.rs")),
    ("bus.rs", include_str!("../bus.rs")),
    ("clock.rs", include_str!("../clock.rs")),
    ("dac.rs", include_str!("../dac.rs")),
    ("dma.rs", include_str!("../dma.rs")),
    ("flash.rs", include_str!("../flash.rs")),
    ("gpio.rs", include_str!("../gpio.rs")),
    ("nvic.rs", include_str!("../nvic.rs")),
    ("rcc.rs", include_str!("../rcc.rs")),
    ("timer.rs", include_str!("../timer.rs")),
    ("uart.rs", include_str!("../uart.rs")),
    ("watchdog.rs", include_str!("../watchdog.rs")),
];

/// All differences between the models and a description.
fn differences(description: &Description) -> Vec<String> {
    let mut found = Vec::new();
    for peripheral in LAYOUTS.iter().copied().flatten() {
        let same = SAME.iter().filter(|(model, _)| *model == peripheral.name).map(|(_, other)| *other);
        for name in [peripheral.name].into_iter().chain(same) {
            let has = |part: &str| !(BASIC.contains(&name) && part.starts_with("CC"));
            for register in peripheral.registers.iter().filter(|register| has(register.name)) {
                let place = format!("{name}.{}", register.name);
                found.extend(description.against(&place, register.offset, &description.registers));
                for (field, mask) in register.fields.iter().filter(|(field, _)| has(field)) {
                    found.extend(description.against(&format!("{place}.{field}"), *mask, &description.fields));
                }
            }
        }
    }
    for (name, base) in bases::ALL {
        found.extend(description.against(name, *base, &description.bases));
    }
    for (name, number) in INTERRUPTS {
        // The core's own exceptions are before them.
        found.extend(description.against(
            &format!("INTERRUPT.{name}"),
            u32::from(number) - 16,
            &description.interrupts,
        ));
    }
    found
}

#[test]
fn every_place_is_where_the_svd_file_has_it() {
    let differences = differences(&svd::read());
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

#[test]
fn every_place_is_where_embassys_description_has_it() {
    let differences = differences(&metapac::read());
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

/// The SVD file has none.
#[test]
fn every_request_for_dma_is_embassys() {
    for (peripheral, signal, model) in dma::REQUESTS {
        assert_eq!(metapac::request(peripheral, signal), Some(model), "{peripheral} {signal}");
    }
}

/// What a model had beside its layout nobody would compare.
#[test]
fn no_other_place_stands_in_a_model() {
    let stray = |line: &&str| {
        let digit =
            |behind: &str| line.split(behind).skip(1).any(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
        digit("1 << ") || digit(": u32 = 0x0")
    };
    for (file, source) in SOURCES {
        let code = source.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
        let found: Vec<_> = code.lines().filter(stray).collect();
        assert!(found.is_empty(), "{file}: {found:?}: declare it in the layout");
    }
}

#[test]
fn a_place_that_differs_is_named() {
    for mut description in [svd::read(), metapac::read()] {
        let moved = description.spelled("LPUART1.ISR.ORE");
        *description.fields.get_mut(&moved).expect("the test before found it") <<= 1;
        let lost = description.spelled("DAC1.MCR");
        description.registers.remove(&lost).expect("the test before found it");
        let found = differences(&description);
        let begins = |place: &str| found.iter().filter(|said| said.starts_with(place)).count();
        assert_eq!((found.len(), begins("LPUART1.ISR.ORE: 0x8"), begins("DAC1.MCR:")), (2, 1, 1), "{found:?}");
    }
}
