//! Every message survives the line, the longest fit a frame, and no damage gets through or stops what follows.

use estimator_core::Status;
use estimator_core::record::MAX_LENGTH;
use proptest::prelude::*;
use protocol::frame::MAX_FRAME;
use protocol::{
    BAUD, Deframer, Faults, FrameError, Health, Identity, Mode, Playback, Refusal, Reply, Request, ResetCause, Sample,
    Samples, TableSource, ToDevice, ToHost, Uid, VERSION, encode, stream_every, text,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::num::{NonZeroU8, NonZeroU16};

fn frame(message: &impl Serialize) -> Vec<u8> {
    encode(message, &mut [0; MAX_FRAME]).expect("a message fits its frame").to_vec()
}

fn receive<M: DeserializeOwned>(bytes: &[u8]) -> Vec<Result<M, FrameError>> {
    let mut deframer = Deframer::new();
    bytes.iter().filter_map(|&byte| deframer.push(byte)).collect()
}

/// Requests at their longest.
fn requests() -> Vec<Request> {
    let record = [0xA5; MAX_LENGTH].iter().copied().collect();
    vec![
        Request::Identify,
        Request::Health,
        Request::Forget,
        Request::Pull,
        Request::Push { record, while_estimating: true, rewired: true },
        Request::Erase { while_estimating: false, rewired: false },
        Request::Stream(true),
        Request::SetZero { at_um: f32::MIN },
        Request::ShiftBias { by_um: f32::MAX },
        Request::SetMode(Mode::Linearise),
        Request::Feed([u16::MAX; 64].iter().copied().collect()),
        Request::Refer { first: u32::MAX, references: [f32::MAX; 64].iter().copied().collect(), go: true, hold: true },
        Request::Reset,
        Request::Load { first: u16::MAX, points: [f32::MIN; 64].iter().copied().collect() },
        Request::Play(Playback {
            points: NonZeroU16::MAX,
            crc: u32::MAX,
            every: NonZeroU16::MAX,
            lines: u32::MAX,
            on_trigger: true,
        }),
    ]
}

fn samples(count: usize) -> Samples {
    let sample = Sample {
        code: u16::MAX,
        sensor: Some(u16::MAX),
        displacement: f32::MIN,
        half_width: Some(f32::MAX),
        dac: u16::MAX,
        status: Status::all(),
        faults: Faults::all(),
    };
    Samples { first: u32::MAX, every: NonZeroU8::MAX, samples: (0..count).map(|_| sample).collect() }
}

/// What the device sends, at its longest.
fn answers() -> Vec<ToHost> {
    let health = Health {
        mode: Mode::Linearise,
        ticks: u32::MAX,
        faults: Faults::all(),
        faults_seen: Faults::all(),
        reset: ResetCause::all(),
        last_words: Some(text("x".repeat(200))),
        cycles_last: u32::MAX,
        cycles_max: u32::MAX,
        cycles_period: u32::MAX,
        missed: u32::MAX,
        adc_saturated: u32::MAX,
        voltage_out_of_range: u32::MAX,
        clamped: u32::MAX,
        dac_saturated: u32::MAX,
        out_of_reach: u32::MAX,
        samples_dropped: u32::MAX,
        frames_refused: u32::MAX,
        line_errors: u32::MAX,
        flash_errors: u32::MAX,
        bias_um: f32::MIN,
        bias_age_ticks: Some(Health::OLDEST_BIAS_TICKS),
        supply_mv: Some(u16::MAX),
        brown_out_level: Some(u8::MAX),
        setpoint: Some(u16::MAX),
        lines: u32::MAX,
        triggers_ignored: u32::MAX,
    };
    let identity = Identity {
        board: text("x".repeat(99)),
        uid: Some(Uid([u8::MAX; 12])),
        firmware: text("x".repeat(99)),
        git: text("x".repeat(99)),
        record_version: u16::MAX,
        tick_us: u32::MAX,
        adc_full_scale: u16::MAX,
        dac_full_scale: u16::MAX,
        source: TableSource::None { stored: text("x".repeat(200)), compiled: text("x".repeat(200)) },
        model: text("x".repeat(99)),
        table_crc: u32::MAX,
    };
    let replies = [
        Reply::Health(health),
        Reply::Identity(identity),
        Reply::Table([0; MAX_LENGTH].iter().copied().collect()),
        Reply::Done,
        Reply::Fed(64),
        Reply::Referred { next: u32::MAX, starved: u32::MAX },
        Reply::Resetting { in_ms: u32::MAX },
        Reply::Refused(Refusal::Table(text("µ".repeat(200)))),
        Reply::Refused(Refusal::BeyondSpan { span_um: f32::MAX }),
        Reply::Loaded(u16::MAX),
    ];
    let replies = replies.into_iter().map(|reply| ToHost::Reply { to: u16::MAX, reply });
    replies.chain([ToHost::Samples(samples(32)), ToHost::Samples(samples(1))]).collect()
}

#[test]
fn every_message_at_its_longest_survives_the_line() {
    for request in requests() {
        let message = ToDevice { sequence: u16::MAX, request };
        assert_eq!(receive(&frame(&message)), [Ok(message)]);
    }
    for message in answers() {
        assert_eq!(receive(&frame(&message)), [Ok(message)]);
    }
}

/// What these bytes are is what devices and tools in the field say to each other: a change needs a new [`VERSION`].
#[test]
fn the_wire_format_is_pinned() {
    let hex = |bytes: Vec<u8>| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    let message = ToDevice { sequence: 300, request: Request::Feed([1, 2, 65_520].iter().copied().collect()) };
    assert_eq!(hex(frame(&message)), "0f0cac020a030102f0ff03beed67b300");
    assert_eq!(
        hex(frame(&ToHost::Samples(samples(1)))),
        "250c01ffffffff0fff01ffff0301ffff03ffff7fff01ffff7f7fffff03ffffff0189760d0b00"
    );
    let all: Vec<u8> = answers().iter().flat_map(frame).collect();
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&all);
    assert_eq!((VERSION, crc), (12, 3374953552));
}

#[test]
fn the_stream_leaves_a_fifth_of_the_line_at_every_rate() {
    let every = [1_000, 2_000, 5_000, 10_000].map(|hz| stream_every(hz).get());
    assert_eq!(every, [1, 1, 2, 4]);
    for (hz, every) in [1_000, 2_000, 5_000, 10_000].into_iter().zip(every) {
        // What comes within the 4 ms after which samples are sent.
        let samples_hz = hz as f64 / f64::from(every);
        let batch = samples((samples_hz * 4e-3) as usize);
        let bits = frame(&ToHost::Samples(batch.clone())).len() * 10;
        let share = bits as f64 * samples_hz / batch.samples.len() as f64 / f64::from(BAUD);
        assert!(share < 0.8, "{hz} Hz: {share}");
    }
}

#[test]
fn another_version_is_refused_by_name() {
    let mut content = vec![VERSION + 1, 7];
    content.extend(crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&content).to_le_bytes());
    let mut bytes = vec![0; 32];
    let length = cobs::encode(&content, &mut bytes);
    bytes.truncate(length);
    bytes.push(0);
    assert_eq!(receive::<ToHost>(&bytes), [Err(FrameError::Version { found: VERSION + 1 })]);
}

#[test]
fn too_long_empty_and_trailing() {
    let good = ToDevice { sequence: 1, request: Request::Identify };
    let mut bytes = vec![0, 0, 0];
    bytes.extend([1; 3 * MAX_FRAME]);
    bytes.push(0);
    bytes.extend(frame(&good));
    assert_eq!(receive(&bytes), [Err(FrameError::TooLong), Ok(good.clone())]);
    assert_eq!(receive::<ToHost>(&frame(&(good, 1u8, 2u8, 3u8))), [Err(FrameError::Content)]);
}

#[test]
fn a_waveform_has_a_point_and_a_tick_at_least() {
    // `ToDevice` with `Request::Play`, the fifteenth of the requests, field by field.
    let play = |points: u16, every: u16| frame(&(9u16, 14u32, (points, 0u32, every, 0u32, false)));
    let one = NonZeroU16::MIN;
    let how = Playback { points: one, crc: 0, every: one, lines: 0, on_trigger: false };
    assert_eq!(receive(&play(1, 1)), [Ok(ToDevice { sequence: 9, request: Request::Play(how) })]);
    for (points, every) in [(0, 1), (1, 0)] {
        assert_eq!(receive::<ToDevice>(&play(points, every)), [Err(FrameError::Content)], "{points}, {every}");
    }
}

proptest! {
    /// A damaged frame is refused, and the next one is received.
    #[test]
    fn damage_costs_one_frame(which in 0usize..15, at in 0usize..400, flip in 1u8.., cut: bool) {
        let message = ToDevice { sequence: 9, request: requests()[which].clone() };
        let mut bytes = frame(&message);
        let at = at % (bytes.len() - 1);
        if cut { bytes.remove(at); } else { bytes[at] ^= flip; }
        // A flip that makes a delimiter splits the frame.
        let good = ToDevice { sequence: 10, request: Request::Health };
        bytes.extend(frame(&good));
        let received = receive::<ToDevice>(&bytes);
        let (last, before) = received.split_last().expect("the good frame");
        prop_assert_eq!(last, &Ok(good));
        prop_assert!(before.iter().all(Result::is_err) && before.len() <= 2);
    }

    #[test]
    fn noise_is_no_message(noise in prop::collection::vec(any::<u8>(), 0..2000)) {
        for found in receive::<ToDevice>(&noise).into_iter().chain(receive(&noise)) {
            prop_assert!(found.is_err());
        }
    }
}
