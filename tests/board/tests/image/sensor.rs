//! The second channel: what the sensor's pin shows stands beside the monitor's code of the same trigger,
//! in every sample.

use crate::common::{Bench, triangle};
use anyhow::Result;
use protocol::{Faults, Request};

/// Codes from one end of the converter to the other, which repeat out of step with the monitor's.
fn sensor(n: u64) -> u16 {
    (n * 4_095 % 65_521) as u16
}

#[test]
fn both_codes_of_a_trigger_are_in_its_sample_and_the_sensor_is_never_a_fault() -> Result<()> {
    let mut bench = Bench::started()?;
    bench.does(Request::Stream(true))?;
    bench.board.feed_sensor(sensor);
    // Counts both from here on.
    bench.board.feed(triangle);
    bench.samples.clear();
    bench.run(1.5)?;
    let mut found = bench.samples.iter().flat_map(|batch| (batch.first..).zip(&batch.samples));
    // Of the trigger before and of one going on, the count began anew.
    let read = |&(_, sample): &(u32, &protocol::Sample)| (sample.code, sample.sensor) == (triangle(1), Some(sensor(1)));
    let (start, _) = found.find(read).expect("the second sequence is streamed");
    let mut count = 0;
    for (tick, sample) in found {
        let n = u64::from(tick - start) + 1;
        assert_eq!((sample.code, sample.sensor), (triangle(n), Some(sensor(n))), "sequence {n}");
        count += 1;
    }
    assert!(count > 2_900, "{count} samples");
    let health = bench.health()?;
    assert_eq!((health.faults_seen, health.missed, health.samples_dropped), (Faults::empty(), 0, 0));
    Ok(())
}
