//! A table over recorded voltages, as a board runs it: `tick table.bin volts.csv`.
//!
//! A line of `volts.csv` is the amplifier's voltage at a tick, V. Where a second number stands behind a comma, somebody
//! says where the actuator is then, µm, as `piezo zero --at` does; from there on the ± is known, where the table has
//! one. What is printed for each tick: voltage (V), displacement at the next tick (µm), its ± (µm), status.
//!
//!     cargo run --example tick -- tests/data/table/generalised-prandtl-ishlinskii/table.bin volts.csv

use estimator_core::{Estimate, Estimator, Table};
use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let mut paths = env::args_os().skip(1).map(PathBuf::from);
    let (Some(table), Some(volts)) = (paths.next(), paths.next()) else {
        return Err("tick table.bin volts.csv".into());
    };
    let table = Table::parse(&fs::read(table)?)?;
    let mut estimator = Estimator::<f32>::new(&table);
    let lines = fs::read_to_string(&volts).map_err(|error| format!("{}: {error}", volts.display()))?;
    println!("{:>8} {:>9} {:>7} status", "V", "µm", "± µm");
    for (index, line) in lines.lines().enumerate() {
        let wrong = |error| format!("line {}, {line:?}: {error}", index + 1);
        let (volts, known) = line.split_once(',').map_or((line, None), |(volts, known)| (volts, Some(known)));
        let voltage = volts.trim().parse().map_err(wrong)?;
        let Estimate { displacement, half_width, status, .. } = estimator.tick_volts(voltage);
        let half_width = half_width.map_or_else(|| "–".to_owned(), |um| format!("{um:.3}"));
        println!("{voltage:8.3} {displacement:9.4} {half_width:>7} {status:?}");
        if let Some(known) = known
            && !estimator.set_zero(known.trim().parse().map_err(wrong)?)
        {
            println!("not taken: what moved before the first tick may still be on its way");
        }
    }
    Ok(())
}
