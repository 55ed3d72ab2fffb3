//! ADC1 (RM0440): injected sequences of one to three channels started by TIM6's trigger, with hardware oversampling,
//! and regular conversions of the internal reference started by software.
//!
//! A conversion takes (sampling time + 12.5) ADC clocks times the oversampling ratio; that of a sequence's next rank
//! begins where the one before ends. Each raises JEOC, the last JEOS as well. The code that JDR1 to JDR3 or DR shows
//! comes from outside as it is; its range is checked against the oversampling that the registers ask for. Calibration
//! and switching on take no time. Injected and regular conversions do not delay each other. Refused: longer sequences,
//! channels that nothing is connected to, other resolutions and alignments, the JSQR queue, DMA, continuous and
//! externally started regular conversion.

use anyhow::{Result, bail, ensure};

use crate::{
    CORE_HZ, NEVER,
    bases::{ADC1, ADC12_COMMON},
    layout::{field, layout},
    rcc::Rcc,
    record::{Conversion, Record},
};

layout! {
    "ADC1" {
        ISR @ 0x00 { ADRDY = 0, EOC = 2, EOS = 3, JEOC = 5, JEOS = 6 }
        IER @ 0x04 { EOCIE = 2, EOSIE = 3, JEOCIE = 5, JEOSIE = 6 }
        CR @ 0x08 {
            ADEN = 0, ADDIS = 1, ADSTART = 2, JADSTART = 3, ADSTP = 4, JADSTP = 5, ADVREGEN = 28, DEEPPWD = 29, ADCALDIF = 30, ADCAL = 31,
        }
        CFGR @ 0x0C { OVRMOD = 12, JQDIS = 31 }
        CFGR2 @ 0x10 { ROVSE = 0, JOVSE = 1, OVSR = 2..=4, OVSS = 5..=8 }
        SMPR1 @ 0x14 { SMP0 = 0..=2, SMP9 = 27..=29 }
        SMPR2 @ 0x18 { SMP10 = 0..=2, SMP18 = 24..=26 }
        SQR1 @ 0x30 { L = 0..=3, SQ1 = 6..=10 }
        DR @ 0x40 {}
        JSQR @ 0x4C { JL = 0..=1, JEXTSEL = 2..=6, JEXTEN = 7..=8, JSQ1 = 9..=13, JSQ2 = 15..=19, JSQ3 = 21..=25 }
        JDR1 @ 0x80 {}
        JDR2 @ 0x84 {}
        JDR3 @ 0x88 {}
    }
    "ADC12_COMMON" {
        CCR @ 0x08 { CKMODE = 16..=17, PRESC = 18..=21, VREFEN = 22 }
    }
}

/// CCR, counted from ADC1's first register.
const COMMON: u32 = ADC12_COMMON - ADC1 + CCR;
/// The ranks of an injected sequence.
const RANKS: [u32; 3] = [JSQ1, JSQ2, JSQ3];
/// The sampling times of ten channels in each register, three bits each.
const CHANNELS: u32 = 10;
const TIME: u32 = 3;
const _: () = assert!(SMP9 == SMP0 << (9 * TIME) && SMP10 == SMP0 && SMP18 == SMP10 << (8 * TIME));
const _: () = assert!(EOCIE | EOSIE == EOC | EOS && JEOCIE | JEOSIE == JEOC | JEOS);

/// TIM6's TRGO among the injected triggers (JEXTSEL), and its rising edge (JEXTEN).
const TIM6_TRGO: u32 = 14;
const RISING: u32 = 1;
/// ADC1's channels: those of the amplifier's voltage, of the sensor, of the set-point, and of the internal reference.
const AMPLIFIER: u32 = 1;
const SENSOR: u32 = 2;
const SETPOINT: u32 = 15;
const VREFINT: u32 = 18;
const FASTEST_HZ: u32 = 60_000_000;
/// Dividers by the field PRESC.
const DIVIDERS: [u32; 12] = [1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256];
/// SMPx's sampling times in half ADC clocks.
const SAMPLING: [u64; 8] = [5, 13, 25, 49, 95, 185, 495, 1281];

/// What the pins and the reference give.
pub struct Inputs {
    /// The code of the amplifier's voltage in the n-th injected sequence, counted from 0, of what the DAC's
    /// pin shows then.
    pub codes: Box<dyn FnMut(u64, Option<u16>) -> u16>,
    /// The sensor's code in the n-th injected sequence.
    pub sensor: Box<dyn FnMut(u64) -> u16>,
    /// The set-point's code in the n-th injected sequence.
    pub setpoint: Box<dyn FnMut(u64) -> u16>,
    /// Sequences so far.
    pub converted: u64,
    pub pin: Option<u16>,
    /// The code of the internal reference.
    pub reference: u16,
    /// The conversions of the internal reference end.
    pub measures: bool,
}

impl Default for Inputs {
    fn default() -> Self {
        Self {
            codes: Box::new(|_, _| 0),
            sensor: Box::new(|_| 0),
            setpoint: Box::new(|_| 0),
            converted: 0,
            pin: None,
            reference: 24_000,
            measures: true,
        }
    }
}

/// The injected conversion going on.
#[derive(Clone, Copy)]
struct Converting {
    trigger: u64,
    end: u64,
    /// Its place in the sequence, from 0.
    rank: usize,
}

#[derive(Default)]
pub struct Adc {
    isr: u32,
    ier: u32,
    cr: u32,
    cfgr: u32,
    cfgr2: u32,
    sampling: [u32; 2],
    sequence: u32,
    injected: u32,
    data: u32,
    injected_data: [u32; 3],
    common: u32,
    converting: Option<Converting>,
    /// End of the regular conversion going on.
    measuring: Option<u64>,
}

impl Adc {
    pub fn new() -> Self {
        Self { cr: DEEPPWD, cfgr: JQDIS, ..Self::default() }
    }

    pub fn due(&self) -> u64 {
        self.converting.map_or(NEVER, |converting| converting.end).min(self.measuring.unwrap_or(NEVER))
    }

    pub fn interrupt(&self) -> bool {
        self.isr & self.ier != 0
    }

    /// Oversampling ratio and right shift.
    fn oversampling(&self, enabled: u32) -> (u32, u32) {
        if self.cfgr2 & enabled == 0 { (1, 0) } else { (2 << field(self.cfgr2, OVSR), field(self.cfgr2, OVSS)) }
    }

    /// Core clocks that `ratio` samples of a channel take.
    fn duration(&self, channel: u32, ratio: u32, rcc: &Rcc) -> Result<u64> {
        let hz = match field(self.common, CKMODE) {
            0 => rcc.adc_hz()? / DIVIDERS[field(self.common, PRESC).min(11) as usize],
            mode => CORE_HZ >> (mode - 1),
        };
        ensure!(hz <= FASTEST_HZ, "ADC1 runs at {hz} Hz; it stands {FASTEST_HZ} Hz");
        let sampling = field(self.sampling[(channel / CHANNELS) as usize], SMP0 << (TIME * (channel % CHANNELS)));
        let half_clocks = (SAMPLING[sampling as usize] + 25) * u64::from(ratio);
        Ok(half_clocks * u64::from(CORE_HZ) / (2 * u64::from(hz)))
    }

    /// Converts where TIM6 triggers.
    pub fn trigger(&mut self, at: u64, rcc: &Rcc, record: &mut Record) -> Result<()> {
        let chosen = (field(self.injected, JEXTSEL), field(self.injected, JEXTEN));
        if self.cr & (ADEN | JADSTART) != ADEN | JADSTART || chosen != (TIM6_TRGO, RISING) {
            return Ok(());
        }
        if self.converting.is_some() {
            record.lost_triggers += 1;
            return Ok(());
        }
        ensure!(self.cfgr & !OVRMOD == JQDIS, "CFGR = {:#x}: a mode that is not modelled", self.cfgr);
        self.begin(at, at, 0, rcc)
    }

    /// The channel of a rank, from 0, of the injected sequence.
    fn channel(&self, rank: usize) -> u32 {
        field(self.injected, RANKS[rank])
    }

    /// Begins the conversion of a rank of the sequence that was triggered at `trigger`.
    fn begin(&mut self, trigger: u64, at: u64, rank: usize, rcc: &Rcc) -> Result<()> {
        let channel = self.channel(rank);
        ensure!(
            [AMPLIFIER, SENSOR, SETPOINT].contains(&channel),
            "channel {channel} is converted; channels {AMPLIFIER}, {SENSOR} and {SETPOINT} are connected"
        );
        let (ratio, _) = self.oversampling(JOVSE);
        self.converting = Some(Converting { trigger, end: at + self.duration(channel, ratio, rcc)?, rank });
        Ok(())
    }

    /// The conversion that ends at `at`.
    pub fn advance(&mut self, at: u64, inputs: &mut Inputs, rcc: &Rcc, record: &mut Record) -> Result<()> {
        if self.measuring == Some(at) && !inputs.measures {
            // It is looked at again a millisecond later.
            self.measuring = Some(at + u64::from(CORE_HZ) / 1_000);
        }
        if self.measuring == Some(at) {
            self.measuring = None;
            self.data = self.fitting(inputs.reference, ROVSE)?;
            self.isr |= EOC | EOS;
            self.cr &= !ADSTART;
        }
        if let Some(Converting { trigger, end, rank }) = self.converting.filter(|converting| converting.end == at) {
            self.converting = None;
            let code = match self.channel(rank) {
                SENSOR => (inputs.sensor)(inputs.converted),
                SETPOINT => (inputs.setpoint)(inputs.converted),
                _ => (inputs.codes)(inputs.converted, inputs.pin),
            };
            self.injected_data[rank] = self.fitting(code, JOVSE)?;
            self.isr |= JEOC;
            if rank < self.last_rank() {
                return self.begin(trigger, end, rank + 1, rcc);
            }
            inputs.converted += 1;
            record.conversions.push(Conversion { trigger, end, late: self.isr & JEOS != 0 });
            self.isr |= JEOS;
        }
        Ok(())
    }

    /// JL: the last rank of the injected sequence, from 0.
    fn last_rank(&self) -> usize {
        field(self.injected, JL) as usize
    }

    /// The code, if the oversampling that is set can give it.
    fn fitting(&self, code: u16, enabled: u32) -> Result<u32> {
        let (ratio, shift) = self.oversampling(enabled);
        let greatest = (4095 * ratio) >> shift;
        ensure!(greatest <= 0xFFFF, "{ratio} samples shifted by {shift} overflow the 16 bits of the data register");
        ensure!(
            u32::from(code) <= greatest,
            "code {code} was fed; oversampled {ratio} times, shifted by {shift}, the greatest is {greatest}"
        );
        Ok(code.into())
    }

    /// Oversampling ratio and right shift of injected conversions.
    pub fn injected_oversampling(&self) -> (u32, u32) {
        self.oversampling(JOVSE)
    }

    pub fn read(&mut self, offset: u32) -> Option<u32> {
        Some(match offset {
            ISR => self.isr,
            IER => self.ier,
            CR => self.cr,
            CFGR => self.cfgr,
            CFGR2 => self.cfgr2,
            SMPR1 | SMPR2 => self.sampling[(offset - SMPR1) as usize / 4],
            SQR1 => self.sequence,
            JSQR => self.injected,
            COMMON => self.common,
            DR => {
                self.isr &= !EOC;
                self.data
            }
            JDR1 | JDR2 | JDR3 => {
                self.isr &= !JEOC;
                self.injected_data[(offset - JDR1) as usize / 4]
            }
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, now: u64, rcc: &Rcc) -> Result<bool> {
        let idle = self.cr & (ADSTART | JADSTART) == 0;
        match offset {
            ISR => self.isr &= !value,
            IER => self.ier = value,
            CR => self.control(value, now, rcc)?,
            CFGR => self.cfgr = value,
            CFGR2 | SMPR1 | SMPR2 if !idle => bail!("register {offset:#x} is written while conversions are on"),
            CFGR2 => self.cfgr2 = value,
            SMPR1 | SMPR2 => self.sampling[(offset - SMPR1) as usize / 4] = value,
            SQR1 => self.sequence = value,
            JSQR => {
                ensure!(
                    (field(value, JL) as usize) < RANKS.len(),
                    "JSQR = {value:#x}: no more than three injected channels are modelled"
                );
                self.injected = value;
            }
            COMMON => self.common = value,
            DR | JDR1 | JDR2 | JDR3 => {}
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// CR: its bits can be set by writing 1 and are cleared by the hardware, but for the voltage regulator's.
    fn control(&mut self, value: u32, now: u64, rcc: &Rcc) -> Result<()> {
        if value & ADCAL != 0 {
            ensure!(value & ADVREGEN != 0 && self.cr & ADEN == 0, "ADCAL needs ADVREGEN and no ADEN");
        }
        let sticky = ADEN | ADSTART | JADSTART;
        let before = self.cr & sticky;
        let mut after = before | value & sticky;
        ensure!(after == before || value & DEEPPWD == 0 && value & ADVREGEN != 0, "ADC1 is used without its regulator");
        if after & ADEN == 0 {
            after = 0;
        }
        if value & ADSTP != 0 {
            after &= !ADSTART;
            self.measuring = None;
        }
        if value & JADSTP != 0 {
            after &= !JADSTART;
            self.converting = None;
        }
        if value & ADDIS != 0 && after & (ADSTART | JADSTART) == 0 {
            after = 0;
        }
        if after & !before & ADEN != 0 {
            self.isr |= ADRDY;
        }
        if after & !before & ADSTART != 0 {
            let channel = field(self.sequence, SQ1);
            ensure!(
                field(self.sequence, L) == 0 && channel == VREFINT && self.common & VREFEN != 0,
                "a regular conversion of channel {channel}; the model has that of the switched-on VREFINT, {VREFINT}, alone"
            );
            ensure!(self.cfgr & !OVRMOD == JQDIS, "CFGR = {:#x}: a mode that is not modelled", self.cfgr);
            let (ratio, _) = self.oversampling(ROVSE);
            self.measuring = Some(now + self.duration(channel, ratio, rcc)?);
        }
        self.cr = value & (ADVREGEN | DEEPPWD | ADCALDIF) | after;
        Ok(())
    }
}

#[cfg(test)]
mod tests;
