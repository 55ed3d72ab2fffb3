//! What the line may bring: noise, and more than it can carry away.

use protocol::frame::MAX_FRAME;
use protocol::{BAUD, Deframer, Reply, Request, ToDevice, ToHost, encode};
use qemu_test::{Board, send_through};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};

/// The emulated UART takes some ten thousand bytes a second; the board's emulator is sent a hundred thousand frames.
const FRAMES: u32 = 2_000;

fn frame(request: Request) -> Vec<u8> {
    encode(&ToDevice { sequence: 77, request }, &mut [0; MAX_FRAME]).unwrap().to_vec()
}

/// Half of them noise, half of them requests with one change.
fn bad_frame(random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = if random.random_bool(0.5) {
        let length = random.random_range(1..64);
        let mut noise = vec![0; length];
        random.fill_bytes(&mut noise);
        noise
    } else {
        let requests = [
            Request::Health,
            Request::Reset,
            Request::Erase { while_estimating: true, rewired: true },
            Request::Feed([30_000; 16].iter().copied().collect()),
            Request::Push { record: [7; 100].iter().copied().collect(), while_estimating: true, rewired: true },
        ];
        let mut bytes = frame(requests[random.random_range(0..requests.len())].clone());
        let at = random.random_range(0..bytes.len() - 1);
        if random.random_bool(0.5) {
            bytes[at] ^= random.random_range(1..=255);
        } else {
            bytes.truncate(at);
        }
        bytes
    };
    bytes.push(0);
    bytes
}

#[test]
fn bad_frames_do_no_harm() {
    let board = Board::power_on();
    let before = board.info();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut line = board.line();
    let mut deframer = Deframer::new();
    let mut ticks = 0;
    for _ in 0..20 {
        let mut chunk: Vec<u8> = (0..FRAMES / 20).flat_map(|_| bad_frame(&mut random)).collect();
        chunk.extend(frame(Request::Health));
        let mut received = send_through(&mut line, &chunk);
        let start = Instant::now();
        // No damaged request is answered; the whole one at the end is.
        let health = loop {
            let replies: Vec<ToHost> = received
                .iter()
                .filter_map(|&byte| deframer.push(byte))
                .map(|reply| reply.expect("a whole frame"))
                .collect();
            match &replies[..] {
                [] => assert!(start.elapsed() < Duration::from_secs(30), "no answer after {ticks} ticks"),
                [ToHost::Reply { to: 77, reply: Reply::Health(health) }] => break health.clone(),
                other => panic!("a damaged request was answered: {other:?}"),
            }
            received = send_through(&mut line, &[]);
        };
        assert!(health.ticks > ticks && health.last_words.is_none(), "it ticks on: {health:?}");
        ticks = health.ticks;
    }
    drop(line);
    let after = board.info();
    assert_eq!(after["identity"], before["identity"]);
    // Some noise is nothing but empty frames, and the emulated UART may have been overrun.
    let bad = after["health"]["frames_refused"].as_u64().unwrap();
    assert!(bad > u64::from(FRAMES) / 2, "only {bad} frames were refused");
}

#[test]
fn the_full_stream_is_gapless_and_fits_the_line() {
    let board = Board::power_on();
    let mut line = board.line();
    line.write_all(&frame(Request::Stream(true))).unwrap();
    let (mut deframer, mut next, mut bytes, mut buffer) = (Deframer::new(), None, 0, [0; 4096]);
    let (mut samples, mut gaps) = (0, 0);
    let start = Instant::now();
    while samples < 6_000 {
        assert!(start.elapsed() < Duration::from_secs(60), "{samples} samples in a minute");
        let length = match line.read(&mut buffer) {
            Ok(0) => panic!("the emulator has closed the line"),
            Ok(length) => length,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
            Err(error) => panic!("the line: {error}"),
        };
        bytes += length;
        for message in buffer[..length].iter().filter_map(|&byte| deframer.push::<ToHost>(byte)) {
            if let ToHost::Samples(batch) = message.expect("whole frames") {
                gaps += u32::from(next.is_some_and(|next| next != batch.first));
                next = Some(batch.first + batch.samples.len() as u32);
                samples += batch.samples.len();
            }
        }
    }
    line.write_all(&frame(Request::Stream(false))).unwrap();
    assert_eq!(gaps, 0);
    // Ten bits a byte, 2,000 samples a second.
    let rate = bytes as f64 * 10.0 / (samples as f64 / 2_000.0);
    println!("{rate:.0} bit/s, {:.1} % of the line", 100.0 * rate / f64::from(BAUD));
    assert!(rate < 0.5 * f64::from(BAUD), "{rate} bit/s");
}
