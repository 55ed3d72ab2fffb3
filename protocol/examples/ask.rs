//! The least that a host of one's own must do: asks a device who it is, and prints the first samples of its stream.
//!
//!     cargo run --release -- emulate
//!     cargo run --example ask -- 127.0.0.1:4740
//!
//! A serial port does as well as this socket: whatever reads and writes bytes. What a real host does besides: it sends
//! a request again where no reply comes, and counts the samples that are missing by their numbers.

use protocol::frame::MAX_FRAME;
use protocol::{Deframer, Reply, Request, ToDevice, ToHost, encode};
use std::error::Error;
use std::io::{BufReader, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

fn main() -> Result<(), Box<dyn Error>> {
    let address = std::env::args().nth(1).ok_or("ask ADDRESS:PORT")?;
    let mut line = TcpStream::connect(address)?;
    line.set_read_timeout(Some(Duration::from_secs(2)))?;
    let mut answers = BufReader::new(line.try_clone()?).bytes();
    let mut deframer = Deframer::new();
    let mut next = || -> Result<ToHost, Box<dyn Error>> {
        loop {
            let byte = answers.next().ok_or("the device has closed the line")??;
            match deframer.push(byte) {
                Some(Ok(message)) => return Ok(message),
                // A line that is joined in the middle of a frame begins with a damaged one.
                Some(Err(error)) => eprintln!("{error}"),
                None => {}
            }
        }
    };
    for (sequence, request) in (0..).zip([Request::Identify, Request::Stream(true)]) {
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(&ToDevice { sequence, request }, &mut buffer).ok_or("a request longer than a frame")?;
        line.write_all(frame)?;
    }
    let mut seen = 0;
    while seen < 10 {
        match next()? {
            ToHost::Reply { reply: Reply::Identity(identity), .. } => {
                println!("{}, firmware {}, a tick of {} µs", identity.board, identity.firmware, identity.tick_us);
            }
            ToHost::Reply { reply, .. } => println!("{reply:?}"),
            ToHost::Samples(samples) => {
                for sample in &samples.samples {
                    println!("{sample:?}");
                    seen += 1;
                }
            }
        }
    }
    Ok(())
}
