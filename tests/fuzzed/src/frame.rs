//! Bytes on the line: whatever becomes a message is one, and nothing keeps the next from being received.

use estimator_core::sealed::{CHECKSUM, seal};
use protocol::frame::MAX_FRAME;
use protocol::{Deframer, FrameError, Reply, Request, ToDevice, ToHost, VERSION, encode};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Bytes as they come, and as the content of a frame that is as it should be. Whether that is a message.
///
/// # Panics
/// A promise is broken.
pub fn check(bytes: &[u8]) -> bool {
    stream::<ToDevice>(bytes, &ToDevice { sequence: 7, request: Request::Health });
    stream::<ToHost>(bytes, &ToHost::Reply { to: 7, reply: Reply::Done });
    [content::<ToDevice>(bytes), content::<ToHost>(bytes)].contains(&true)
}

/// What a receiver makes of some bytes, and of a message after them.
fn stream<M: Serialize + DeserializeOwned>(bytes: &[u8], message: &M) {
    let mut deframer = Deframer::new();
    let mut receive = |bytes: &[u8]| bytes.iter().filter_map(|&byte| deframer.push::<M>(byte)).collect::<Vec<_>>();
    receive(bytes).iter().flatten().for_each(survives);
    // The end of whatever was on the line.
    receive(&[0]).iter().flatten().for_each(survives);
    let mut buffer = [0; MAX_FRAME];
    let frame = encode(message, &mut buffer).expect("it fits a frame").to_vec();
    let received = receive(&frame);
    let [Ok(received)] = &received[..] else { panic!("the next message is not received") };
    assert_eq!(encode(received, &mut buffer), Some(&frame[..]));
}

/// Content of the right version, behind the right checksum. Whether it is a message.
fn content<M: Serialize + DeserializeOwned>(bytes: &[u8]) -> bool {
    let mut content = [&[VERSION], bytes, &[0; CHECKSUM]].concat();
    let end = content.len() - CHECKSUM;
    seal(&mut content, end).expect("there is room for the checksum");
    let mut frame = cobs_of(&content);
    frame.push(0);
    let mut deframer = Deframer::new();
    let received: Vec<_> = frame.iter().filter_map(|&byte| deframer.push::<M>(byte)).collect();
    match &received[..] {
        [Ok(message)] => {
            survives(message);
            true
        }
        [Err(FrameError::Content)] => false,
        [Err(FrameError::TooLong)] => {
            assert!(frame.len() > MAX_FRAME);
            false
        }
        other => panic!("{:?}", other.iter().map(|received| received.as_ref().err()).collect::<Vec<_>>()),
    }
}

fn cobs_of(content: &[u8]) -> Vec<u8> {
    let mut stuffed = vec![0; cobs::max_encoding_length(content.len())];
    let length = cobs::encode(content, &mut stuffed);
    stuffed.truncate(length);
    stuffed
}

/// A message is sent as a frame that becomes the same message: by its bytes, since a NaN is not equal to itself. (A
/// number may have come in more bytes than it needs, so that the frame which it came in may be another.)
fn survives<M: Serialize + DeserializeOwned>(message: &M) {
    let (mut first, mut second) = ([0; MAX_FRAME], [0; MAX_FRAME]);
    let frame = encode(message, &mut first).expect("what was received can be sent");
    let mut deframer = Deframer::new();
    let received: Vec<_> = frame.iter().filter_map(|&byte| deframer.push::<M>(byte)).collect();
    let [Ok(again)] = &received[..] else { panic!("what is sent is not received") };
    assert_eq!(encode(again, &mut second), Some(frame), "a message has changed on the way");
}
