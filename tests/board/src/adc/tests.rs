//! ADC1 by its registers alone.

use super::*;
use crate::Reset;

/// ADC1 at 42.5 MHz with channel 1 sampled 47.5 clocks, waiting for TIM6, oversampled as `cfgr2` says.
fn armed(cfgr2: u32) -> (Adc, Rcc) {
    let mut rcc = Rcc::new(Reset::PowerOn, 0);
    rcc.write(0x88, 2 << 28);
    let mut adc = Adc::new();
    let enabled = ADVREGEN | ADEN;
    for (offset, value) in [
        (CCR, 2 << 18),
        (CR, ADVREGEN),
        (CR, ADVREGEN | ADCAL),
        (CR, enabled),
        (CFGR2, cfgr2),
        (SMPR1, 4 << 3),
        (JSQR, 1 << 9 | TIM6_TRGO << 2),
        (IER, JEOS),
        (CR, enabled | JADSTART),
    ] {
        assert!(adc.write(offset, value, 0, &rcc).unwrap());
    }
    (adc, rcc)
}

fn inputs(code: u16) -> Inputs {
    Inputs { codes: Box::new(move |_, _| code), converted: 0, pin: None, reference: 1500 }
}

#[test]
fn sixteenfold_oversampling_takes_sixteen_times_as_long_and_gives_16_bits() {
    for (cfgr2, ratio, clocks) in [(0, 1, 240), (JOVSE | 3 << 2, 16, 3840), (JOVSE | 7 << 2 | 4 << 5, 256, 61_440)] {
        let (mut adc, rcc) = armed(cfgr2);
        let (mut inputs, mut record) = (inputs(if ratio == 1 { 4095 } else { 65_520 }), Record::default());
        adc.trigger(1000, &rcc, &mut record).unwrap();
        assert_eq!(adc.due(), 1000 + clocks, "{ratio}");
        adc.advance(adc.due(), &mut inputs, &mut record).unwrap();
        assert!(adc.interrupt());
        assert_eq!(adc.read(JDR1), Some(record.conversions[0].code.into()));
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
        assert!(adc.advance(adc.due(), &mut inputs, &mut record).is_err(), "{cfgr2:#x}");
    }
}

#[test]
fn a_trigger_during_a_conversion_is_lost_and_one_before_the_flag_is_served_is_late() {
    let (mut adc, rcc) = armed(0);
    let (mut inputs, mut record) = (inputs(7), Record::default());
    for at in [0, 100, 500] {
        if adc.due() <= at {
            adc.advance(adc.due(), &mut inputs, &mut record).unwrap();
        }
        adc.trigger(at, &rcc, &mut record).unwrap();
    }
    adc.advance(adc.due(), &mut inputs, &mut record).unwrap();
    assert_eq!(record.lost_triggers, 1);
    assert_eq!(record.conversions.iter().map(|c| (c.trigger, c.late)).collect::<Vec<_>>(), [(0, false), (500, true)]);
}

#[test]
fn the_reference_is_converted_once_when_software_says_so() {
    let (mut adc, rcc) = armed(0);
    let start = ADVREGEN | ADEN | ADSTART;
    adc.write(SQR1, VREFINT << 6, 0, &rcc).unwrap();
    assert!(adc.write(CR, start, 0, &rcc).is_err(), "VREFEN is off");
    adc.write(CCR, VREFEN | 2 << 18, 0, &rcc).unwrap();
    adc.write(CR, start, 0, &rcc).unwrap();
    adc.advance(adc.due(), &mut inputs(0), &mut Record::default()).unwrap();
    assert_eq!(adc.read(ISR).map(|isr| isr & (EOC | EOS)), Some(EOC | EOS));
    assert_eq!((adc.read(DR), adc.read(ISR).map(|isr| isr & EOC)), (Some(1500), Some(0)));
    assert_eq!(adc.read(CR).map(|cr| cr & ADSTART), Some(0));
}
