//! ADC1 by its registers alone.

use super::*;
use crate::Reset;

/// ADC1 at 42.5 MHz with channel 1 sampled 47.5 clocks, waiting for TIM6, oversampled as `cfgr2` says.
fn armed(cfgr2: u32) -> (Adc, Rcc) {
    armed_with(cfgr2, ONE_RANK)
}

/// JSQR of a sequence of the amplifier's channel alone.
const ONE_RANK: u32 = AMPLIFIER << 9;
/// The sensor's channel behind it.
const TWO_RANKS: u32 = ONE_RANK | SENSOR << 15 | 1;
/// And the set-point's behind both.
const THREE_RANKS: u32 = ONE_RANK | SENSOR << 15 | SETPOINT << 21 | 2;

/// The same of another sequence, with channel 2 sampled 24.5 clocks and channel 15 6.5.
fn armed_with(cfgr2: u32, ranks: u32) -> (Adc, Rcc) {
    let mut rcc = Rcc::new(Reset::PowerOn, 0);
    rcc.write(0x88, 2 << 28);
    let mut adc = Adc::new();
    let enabled = ADVREGEN | ADEN;
    for (offset, value) in [
        (COMMON, 2 << 18),
        (CR, ADVREGEN),
        (CR, ADVREGEN | ADCAL),
        (CR, enabled),
        (CFGR2, cfgr2),
        (SMPR1, 4 << 3 | 3 << 6),
        (SMPR2, 1 << 15),
        (JSQR, ranks | TIM6_TRGO << 2 | RISING << 7),
        (IER, JEOS),
        (CR, enabled | JADSTART),
    ] {
        assert!(adc.write(offset, value, 0, &rcc).unwrap());
    }
    (adc, rcc)
}

fn inputs(code: u16) -> Inputs {
    Inputs { codes: Box::new(move |_, _| code), reference: 1500, ..Inputs::default() }
}

#[test]
fn sixteenfold_oversampling_takes_sixteen_times_as_long_and_gives_16_bits() {
    for (cfgr2, ratio, clocks) in [(0, 1, 240), (JOVSE | 3 << 2, 16, 3840), (JOVSE | 7 << 2 | 4 << 5, 256, 61_440)] {
        let (mut adc, rcc) = armed(cfgr2);
        let (mut inputs, mut record) = (inputs(if ratio == 1 { 4095 } else { 65_520 }), Record::default());
        adc.trigger(1000, &rcc, &mut record).unwrap();
        assert_eq!(adc.due(), 1000 + clocks, "{ratio}");
        adc.advance(adc.due(), &mut inputs, &rcc, &mut record).unwrap();
        assert!(adc.interrupt());
        assert_eq!(adc.read(JDR1), Some(if ratio == 1 { 4095 } else { 65_520 }));
        assert_eq!(adc.read(ISR).map(|isr| isr & (JEOC | JEOS)), Some(JEOS), "reading JDR1 clears JEOC alone");
        adc.write(ISR, JEOS, 0, &rcc).unwrap();
        assert!(!adc.interrupt());
    }
}

#[test]
fn a_code_beyond_the_oversampling_is_refused() {
    for (cfgr2, code) in [(0, 4096), (JOVSE | 3 << 2, 65_521), (JOVSE | 3 << 2 | 4 << 5, 4096), (JOVSE | 4 << 2, 1)] {
        let (mut adc, rcc) = armed(cfgr2);
        let (mut inputs, mut record) = (inputs(code), Record::default());
        adc.trigger(0, &rcc, &mut record).unwrap();
        assert!(adc.advance(adc.due(), &mut inputs, &rcc, &mut record).is_err(), "{cfgr2:#x}");
    }
}

#[test]
fn a_trigger_during_a_conversion_is_lost_and_one_before_the_flag_is_served_is_late() {
    let (mut adc, rcc) = armed(0);
    let (mut inputs, mut record) = (inputs(7), Record::default());
    for at in [0, 100, 500] {
        if adc.due() <= at {
            adc.advance(adc.due(), &mut inputs, &rcc, &mut record).unwrap();
        }
        adc.trigger(at, &rcc, &mut record).unwrap();
    }
    adc.advance(adc.due(), &mut inputs, &rcc, &mut record).unwrap();
    assert_eq!(record.lost_triggers, 1);
    assert_eq!(record.conversions.iter().map(|c| (c.trigger, c.late)).collect::<Vec<_>>(), [(0, false), (500, true)]);
}

#[test]
fn the_reference_is_converted_once_when_software_says_so() {
    let (mut adc, rcc) = armed(0);
    let start = ADVREGEN | ADEN | ADSTART;
    adc.write(SQR1, VREFINT << 6, 0, &rcc).unwrap();
    assert!(adc.write(CR, start, 0, &rcc).is_err(), "VREFEN is off");
    adc.write(COMMON, VREFEN | 2 << 18, 0, &rcc).unwrap();
    adc.write(CR, start, 0, &rcc).unwrap();
    adc.advance(adc.due(), &mut inputs(0), &rcc, &mut Record::default()).unwrap();
    assert_eq!(adc.read(ISR).map(|isr| isr & (EOC | EOS)), Some(EOC | EOS));
    assert_eq!((adc.read(DR), adc.read(ISR).map(|isr| isr & EOC)), (Some(1500), Some(0)));
    assert_eq!(adc.read(CR).map(|cr| cr & ADSTART), Some(0));
}

#[test]
fn of_two_ranks_each_has_its_time_and_its_register_and_the_last_ends_the_sequence() {
    // The sensor's channel is sampled for less time.
    for (ranks, first, second, ends) in
        [(TWO_RANKS, 700, 800, [240, 388]), (SENSOR << 9 | AMPLIFIER << 15 | 1, 800, 700, [148, 388])]
    {
        let (mut adc, rcc) = armed_with(0, ranks);
        let mut inputs = Inputs { sensor: Box::new(|n| 800 + n as u16), ..inputs(700) };
        let mut record = Record::default();
        adc.trigger(0, &rcc, &mut record).unwrap();
        assert_eq!(adc.due(), ends[0]);
        adc.advance(adc.due(), &mut inputs, &rcc, &mut record).unwrap();
        assert_eq!(adc.read(ISR).map(|isr| isr & (JEOC | JEOS)), Some(JEOC), "the sequence goes on");
        assert!(!adc.interrupt() && record.conversions.is_empty());
        assert_eq!((adc.read(JDR1), adc.read(JDR2)), (Some(first), Some(0)));
        assert_eq!(adc.read(ISR).map(|isr| isr & JEOC), Some(0));
        adc.trigger(200, &rcc, &mut record).unwrap();
        assert_eq!((record.lost_triggers, adc.due()), (1, ends[1]), "between the ranks a trigger is lost");
        adc.advance(adc.due(), &mut inputs, &rcc, &mut record).unwrap();
        assert!(adc.interrupt());
        assert_eq!((adc.read(JDR1), adc.read(JDR2)), (Some(first), Some(second)));
        assert_eq!(record.conversions.iter().map(|c| (c.trigger, c.end)).collect::<Vec<_>>(), [(0, ends[1])]);
        assert_eq!((adc.due(), inputs.converted), (NEVER, 1));
    }
}

#[test]
fn of_three_ranks_each_has_its_time_and_its_register_and_the_last_ends_the_sequence() {
    let (mut adc, rcc) = armed_with(0, THREE_RANKS);
    let mut inputs = Inputs { sensor: Box::new(|_| 800), setpoint: Box::new(|n| 900 + n as u16), ..inputs(700) };
    let mut record = Record::default();
    adc.trigger(0, &rcc, &mut record).unwrap();
    // 60, 37 and 19 clocks of the ADC.
    for (end, done) in [(240, false), (388, false), (464, true)] {
        assert_eq!(adc.due(), end);
        adc.advance(end, &mut inputs, &rcc, &mut record).unwrap();
        assert_eq!((adc.interrupt(), record.conversions.len()), (done, usize::from(done)));
    }
    assert_eq!([JDR1, JDR2, JDR3].map(|rank| adc.read(rank)), [Some(700), Some(800), Some(900)]);
    assert_eq!(record.conversions.iter().map(|c| (c.trigger, c.end)).collect::<Vec<_>>(), [(0, 464)]);
    assert_eq!((adc.due(), inputs.converted), (NEVER, 1));
}

#[test]
fn what_nothing_is_connected_to_is_refused_in_any_rank_and_so_is_a_fourth() {
    for ranks in [3 << 9, AMPLIFIER << 9 | 3 << 15 | 1, (TWO_RANKS + 1) | 3 << 21] {
        let (mut adc, rcc) = armed_with(0, ranks);
        let mut record = Record::default();
        let mut inputs = inputs(7);
        let mut refused = adc.trigger(0, &rcc, &mut record);
        while refused.is_ok() && adc.due() != NEVER {
            refused = adc.advance(adc.due(), &mut inputs, &rcc, &mut record);
        }
        assert!(refused.is_err(), "{ranks:#x}");
    }
    let (mut adc, rcc) = armed(0);
    assert!(adc.write(JSQR, THREE_RANKS + 1, 0, &rcc).is_err());
}
