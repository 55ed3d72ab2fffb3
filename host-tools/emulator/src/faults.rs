//! Faults for a [`FaultyLine`](crate::FaultyLine) that are wanted often: of the device's replies and of its samples.

use crate::faulty_line::{Direction, Fault};
use protocol::frame::MAX_FRAME;
use protocol::{Deframer, Reply, Request, Samples, ToDevice, ToHost, encode};

/// Decodes what the device sends and lets `edit` say what arrives instead: one message, none, or several. Bytes that
/// are no message pass.
pub fn messages<I: IntoIterator<Item = ToHost>>(mut edit: impl FnMut(ToHost) -> I + Send + 'static) -> impl Fault {
    move |direction, frame: &mut Vec<u8>| {
        if direction == Direction::ToHost
            && let Some(message) = decode(frame)
        {
            *frame = edit(message).into_iter().flat_map(|message| encoded(&message)).collect();
        }
    }
}

/// Decodes what the host asks and lets `edit` say what the device is asked instead: one request, none, or several.
pub fn requests<I: IntoIterator<Item = ToDevice>>(mut edit: impl FnMut(ToDevice) -> I + Send + 'static) -> impl Fault {
    let mut deframer = Deframer::new();
    move |direction, frame: &mut Vec<u8>| {
        if direction == Direction::ToDevice
            && let Some(Ok(asked)) = frame.iter().find_map(|&byte| deframer.push(byte))
        {
            let mut buffer = [0; MAX_FRAME];
            // Never empty: a test of the protocol encodes every message at its longest.
            let mut encoded = |asked| encode(&asked, &mut buffer).unwrap_or_default().to_vec();
            *frame = edit(asked).into_iter().flat_map(&mut encoded).collect();
        }
    }
}

/// Has the device answer that it is told a displacement, and not do it: it is asked to forget its counts instead.
pub fn told_in_vain() -> impl Fault {
    requests(|ToDevice { sequence, request }| {
        let in_vain = matches!(request, Request::SetZero { .. } | Request::ShiftBias { .. });
        [ToDevice { sequence, request: if in_vain { Request::Forget } else { request } }]
    })
}

/// Hands the frame of every reply, with its number from 0, to `fault`.
pub fn replies(mut fault: impl FnMut(u32, &Reply, &mut Vec<u8>) + Send + 'static) -> impl Fault {
    let mut number = 0;
    move |direction, frame: &mut Vec<u8>| {
        if direction == Direction::ToHost
            && let Some(ToHost::Reply { reply, .. }) = decode(frame)
        {
            fault(number, &reply, frame);
            number += 1;
        }
    }
}

/// Loses the replies of these numbers, counted from 0.
pub fn lose_replies(numbers: impl IntoIterator<Item = u32>) -> impl Fault {
    let numbers: Vec<u32> = numbers.into_iter().collect();
    replies(move |number, _, frame| {
        if numbers.contains(&number) {
            frame.clear();
        }
    })
}

/// Changes a byte of a frame, so that it remains one frame.
pub fn damage(frame: &mut [u8]) {
    if let [_, _, byte, .., _] = frame {
        *byte = if *byte == 1 { 2 } else { 1 };
    }
}

/// Lets `edit` change each batch of samples, or lose it by answering `false`.
pub fn samples(mut edit: impl FnMut(&mut Samples) -> bool + Send + 'static) -> impl Fault {
    messages(move |message| match message {
        ToHost::Samples(mut samples) => edit(&mut samples).then_some(ToHost::Samples(samples)),
        reply => Some(reply),
    })
}

/// Loses the one batch of samples that reaches beyond this tick first, counted from the first sample that comes.
pub fn lose_samples_at(tick: u32) -> impl Fault {
    let (mut origin, mut lost) = (None, false);
    samples(move |batch| {
        let from = batch.first.wrapping_sub(*origin.get_or_insert(batch.first));
        let loses = !lost && from + batch.samples.len() as u32 > tick;
        lost |= loses;
        !loses
    })
}

/// Loses all samples from this tick on, counted from the first sample that comes.
pub fn silent_from(tick: u32) -> impl Fault {
    let mut origin = None;
    samples(move |batch| {
        let from = batch.first.wrapping_sub(*origin.get_or_insert(batch.first));
        batch.samples.truncate(tick.saturating_sub(from) as usize);
        !batch.samples.is_empty()
    })
}

/// Turns the last bit of the displacement of the sample with this number.
pub fn wrong_bit_at(number: u32) -> impl Fault {
    samples(move |batch| {
        if let Some(sample) = batch.samples.get_mut(number.wrapping_sub(batch.first) as usize) {
            sample.displacement = f32::from_bits(sample.displacement.to_bits() ^ 1);
        }
        true
    })
}

/// The message of a frame; `None` where it is damaged or of another version.
pub fn decode(frame: &[u8]) -> Option<ToHost> {
    let mut deframer = Deframer::new();
    frame.iter().find_map(|&byte| deframer.push(byte))?.ok()
}

/// The frame of a message.
pub fn encoded(message: &ToHost) -> Vec<u8> {
    // Never empty: a test of the protocol encodes every message at its longest.
    encode(message, &mut [0; MAX_FRAME]).unwrap_or_default().to_vec()
}
