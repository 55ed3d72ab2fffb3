//! Two readings of an instrument beside the codes of the board's converters: what their ends stand for.
//!
//! ```text
//! g = (r₂ − r₁)/(c₂ − c₁)        at code 0: r₁ − g·c₁        at full scale: that + g · full scale
//! ```
//!
//! r is what the instrument read, c the mean of the codes over a second meanwhile. A multimeter at the amplifier's
//! output gives the line of the monitor's channel, and of the DAC where the board drives; the sensor's own display, or
//! a multimeter at its output, that of the second channel. Whatever divider and offsets are in between, they are then
//! in the line.

mod channel;
pub mod doubt;
mod measured;
mod point;

pub use channel::{Averaged, Channel};
pub use measured::{measured, writable};
pub use point::{Point, line};

use crate::calibration_error::CalibrationError;
use crate::driven::{Driven, STAYS_S};
use crate::error::BenchError;
use device_link::Client;
use device_link::interrupt::Interrupt;
use protocol::{Identity, Sample};
use std::time::{Duration, Instant};

/// How long codes are averaged, s.
pub const AVERAGED_S: f64 = 1.0;
/// How often that is tried again while the codes still drift.
const TRIES: u32 = 10;
/// How long samples are waited for.
const SILENCE: Duration = Duration::from_secs(2);
/// How often it is looked whether a reading has come.
const LOOK: Duration = Duration::from_millis(20);

/// How what is measured gets to the two points.
pub enum Stand {
    /// The user brings what is measured to both points by hand.
    ByHand,
    /// The board drives the amplifier to these voltages, V by the table in use.
    Driven(Box<Driven>, [f32; 2]),
}

/// What is to be calibrated, and with what.
pub struct Calibrating<'a> {
    /// The link to the device that samples and drives.
    pub client: &'a mut Client,
    /// What the device says of itself: board, firmware, tick.
    pub identity: &'a Identity,
    /// Which of its inputs.
    pub channel: Channel,
    /// How it gets to the two points.
    pub stand: Stand,
    /// The wish to end.
    pub interrupt: &'a Interrupt,
}

/// The instrument's reading at a point of this number, V or µm, if there is one by now. An error is why the last one
/// was not taken, and said once.
pub type Reading<'r, E> = dyn FnMut(usize, Option<CalibrationError>) -> Result<Option<f64>, E> + 'r;

/// What has come of it.
pub struct Calibrated<E> {
    /// Both points, or why there are none.
    pub points: Result<[Point; 2], E>,
    /// Whether a board that drove has come to rest; the points are as good where it has not.
    pub home: Result<(), BenchError>,
}

impl Calibrating<'_> {
    /// Both points. `reading` is asked again and again, with the point's number, until it has one; the average is taken
    /// then. Where that reading cannot be taken, it is asked for another one with the reason. However this ends, a
    /// board that drove goes to rest.
    ///
    /// Fails where the link does, a fault stops the drive, the codes are saturated, drift or cannot be believed, the
    /// reading cannot be had, or the user has had enough.
    pub fn points<E: From<BenchError>>(mut self, reading: &mut Reading<'_, E>) -> Calibrated<E> {
        let points = self.both(reading);
        let home = match &self.stand {
            Stand::Driven(driven, _) => driven.rest(self.client),
            Stand::ByHand => Ok(()),
        };
        Calibrated { points, home }
    }

    fn both<E: From<BenchError>>(&mut self, reading: &mut Reading<'_, E>) -> Result<[Point; 2], E> {
        if self.identity.tick_us == 0 {
            return Err(BenchError::from(CalibrationError::NoTick).into());
        }
        let first = self.point(&[], reading)?;
        Ok([first, self.point(&[first.reading], reading)?])
    }

    /// The point after those with the readings of `before`.
    fn point<E: From<BenchError>>(&mut self, before: &[f64], reading: &mut Reading<'_, E>) -> Result<Point, E> {
        if let Stand::Driven(driven, volts) = &mut self.stand {
            driven.go(self.client, volts[before.len()], self.interrupt)?;
        }
        let (mut doubt, mut drifted) = (None, 0);
        loop {
            let read = self.reading(before.len(), doubt, reading)?;
            if let Err(why) = self.believed(before, read) {
                doubt = Some(why);
                continue;
            }
            // While the code drifts it is not known where it was when the instrument was read.
            let (channel, dac) = self.averaged()?;
            if channel.stands_still(self.identity.adc_full_scale) {
                return Ok(Point { reading: read, channel, dac });
            }
            drifted += 1;
            let drifts =
                CalibrationError::Drifts { codes: channel.drift.abs(), seconds: f64::from(drifted) * AVERAGED_S };
            if drifted >= TRIES {
                return Err(BenchError::from(drifts).into());
            }
            doubt = Some(drifts);
        }
    }

    /// The reading, once there is one.
    fn reading<E: From<BenchError>>(
        &mut self,
        number: usize,
        mut doubt: Option<CalibrationError>,
        reading: &mut Reading<'_, E>,
    ) -> Result<f64, E> {
        loop {
            if self.interrupt.wanted() {
                return Err(BenchError::from(CalibrationError::Interrupted).into());
            }
            if let Some(read) = reading(number, doubt.take())? {
                return Ok(read);
            }
            match &mut self.stand {
                Stand::ByHand => std::thread::sleep(LOOK),
                // It goes to rest where nobody says that it is to stay.
                Stand::Driven(driven, _) => driven.stay(self.client, self.interrupt).map(drop)?,
            }
        }
    }

    fn believed(&self, before: &[f64], read: f64) -> Result<(), CalibrationError> {
        match (&self.stand, self.channel) {
            (Stand::Driven(driven, volts), Channel::Monitor) => {
                doubt::of_driven(&[before, &[read]].concat(), volts.map(f64::from), driven.far_v())
            }
            _ => Ok(()),
        }
    }

    /// The channel's and the DAC's codes over a second.
    fn averaged(&mut self) -> Result<(Averaged, Option<f64>), BenchError> {
        let samples = self.second()?;
        doubt::of_samples(&samples, self.channel)?;
        let codes: Option<Vec<u16>> = samples.iter().map(|sample| self.channel.code(sample)).collect();
        let channel = Averaged::of(&codes.ok_or(CalibrationError::NoSensor)?, self.identity.adc_full_scale)?;
        let mean = samples.iter().map(|sample| f64::from(sample.dac)).sum::<f64>() / samples.len() as f64;
        Ok((channel, matches!(self.stand, Stand::Driven(..)).then_some(mean)))
    }

    /// The samples of a second.
    fn second(&mut self) -> Result<Vec<Sample>, BenchError> {
        let mut samples = Vec::new();
        if let Stand::Driven(driven, _) = &mut self.stand {
            for _ in 0..(AVERAGED_S / STAYS_S).ceil() as usize {
                samples.extend(driven.stay(self.client, self.interrupt)?);
            }
            return Ok(samples);
        }
        let enough = (AVERAGED_S * 1e6 / f64::from(self.identity.tick_us)) as usize;
        let mut ticks = 0;
        self.client.stream(true)?;
        let mut news = Instant::now();
        while ticks < enough {
            if self.interrupt.wanted() {
                return Err(CalibrationError::Interrupted.into());
            }
            if let Some(batch) = self.client.samples(LOOK)? {
                samples.extend(batch.samples.iter().copied());
                ticks += batch.samples.len() * usize::from(batch.every.get());
                news = Instant::now();
            }
            if news.elapsed() >= SILENCE {
                return Err(CalibrationError::Silent.into());
            }
        }
        self.client.stream(false)?;
        Ok(samples)
    }
}
