//! What a host may ask, in the fuzzer's words.

use arbitrary::Arbitrary;
use core::num::NonZeroU16;
use estimator_core::Admitted;
use estimator_core::record::MAX_LENGTH;
use protocol::waveform::checksum;
use protocol::{Mode, Playback, Record, Request};

/// A request of an arbitrary host.
#[derive(Debug, Arbitrary)]
pub enum Asked {
    Identify,
    Health,
    Forget,
    Pull,
    Push {
        table: u8,
        damage: Option<(u16, u8)>,
        while_estimating: bool,
        rewired: bool,
    },
    Erase {
        while_estimating: bool,
        rewired: bool,
    },
    Stream(bool),
    SetZero(f32),
    ShiftBias(f32),
    SetMode(u8),
    Feed {
        first: u16,
        step: i8,
        count: u8,
    },
    Refer {
        first: u8,
        from: f32,
        step: f32,
        count: u8,
        go: bool,
        hold: bool,
    },
    Reset,
    Load {
        first: u16,
        from: f32,
        step: f32,
        count: u8,
    },
    /// The points of a load of so many from the first one on.
    Play {
        from: f32,
        step: f32,
        count: u8,
        every: u16,
        lines: u8,
        on_trigger: bool,
    },
}

/// At most 64 numbers, each a step after the one before.
fn steps(from: f32, step: f32, count: u8) -> impl Iterator<Item = f32> {
    (0..count % 65).map(move |k| from + step * f32::from(k))
}

impl Asked {
    /// The request, with one of these tables where it is to push one.
    pub fn request(self, tables: &[Admitted]) -> Request {
        match self {
            Self::Identify => Request::Identify,
            Self::Health => Request::Health,
            Self::Forget => Request::Forget,
            Self::Pull => Request::Pull,
            Self::Push { table, damage, while_estimating, rewired } => {
                let mut record = record(&tables[usize::from(table) % tables.len()]);
                if let Some((at, flip)) = damage {
                    let at = usize::from(at) % record.len();
                    record[at] ^= flip;
                }
                Request::Push { record, while_estimating, rewired }
            }
            Self::Erase { while_estimating, rewired } => Request::Erase { while_estimating, rewired },
            Self::Stream(on) => Request::Stream(on),
            Self::SetZero(at_um) => Request::SetZero { at_um },
            Self::ShiftBias(by_um) => Request::ShiftBias { by_um },
            Self::SetMode(number) => Request::SetMode(Mode::from_number(number % 7).unwrap_or_default()),
            Self::Feed { first, step, count } => {
                let codes = (0..i16::from(count % 65)).map(|k| first.wrapping_add_signed(k.wrapping_mul(step.into())));
                Request::Feed(codes.collect())
            }
            Self::Refer { first, from, step, count, go, hold } => {
                Request::Refer { first: first.into(), references: steps(from, step, count).collect(), go, hold }
            }
            Self::Reset => Request::Reset,
            Self::Load { first, from, step, count } => {
                Request::Load { first, points: steps(from, step, count).collect() }
            }
            Self::Play { from, step, count, every, lines, on_trigger } => Request::Play(Playback {
                points: NonZeroU16::new(u16::from(count % 65)).unwrap_or(NonZeroU16::MIN),
                crc: checksum(steps(from, step, count)),
                every: NonZeroU16::new(every).unwrap_or(NonZeroU16::MIN),
                lines: lines.into(),
                on_trigger,
            }),
        }
    }
}

/// A table's record.
pub fn record(table: &Admitted) -> Record {
    let mut buffer = [0; MAX_LENGTH];
    let length = table.encode(&mut buffer).expect("MAX_LENGTH suffices for every table");
    buffer[..length].iter().copied().collect()
}
