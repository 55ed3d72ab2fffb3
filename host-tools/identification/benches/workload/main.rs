//! What identification costs: the thesis's whole workload, 512 million sample-evaluations of nine parameters, by a
//! plain loop, by the recursion of `estimator-core` and by the search's engine, side by side in one run; and how the
//! engine's time grows.
//!
//! `cargo xtask bench` runs it. With `--quick` it does a share of the workload, with `--json` it prints for machines.
//! Before anything is timed the kernels' costs are compared: what is not the same computation cannot be compared in
//! speed. With `--count` it runs a kernel once, for an emulator to count instructions; with `--kernels` it says which
//! there are, and what the machine's widest instructions are.

mod count;
mod plain;
mod race;
mod report;
mod scaling;
mod thesis;

use estimator_core::{Parameters, VoigtParameters};
use identification::Problem;
use identification::cost::Feedback;
use identification::family::voigt;
use plain::Plain;
use race::Kernel;
use rayon::ThreadPool;
use report::{Race, Report, Row, Workload};
use serde_json::json;
use std::process::ExitCode;
use std::thread::available_parallelism;
use thesis::{GENERATIONS, LENGTH_S, POPULATION};

const QUICK: &str = "--quick";
const JSON: &str = "--json";
/// What cargo tells every bench.
const BY_CARGO: &str = "--bench";
const GENERATIONS_IF_QUICK: usize = 40;
/// By what part of itself the recursion's cost may differ from the plain loop's: a table holds its parameters in f32.
const OF_RECURSION: f64 = 1e-4;
/// By what part of itself the engine's cost may differ from the plain loop's: it interpolates between voltages.
const OF_ENGINE: f64 = 2e-3;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != BY_CARGO).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["--kernels"] => println!("{}", json!({ "instructions": instructions(), "kernels": count::names() })),
        ["--count", kernel] => match count::run(kernel) {
            Some(sample_evaluations) => println!("{sample_evaluations}"),
            None => return refused(&format!("{kernel} is no kernel; there are {}", count::names().join(", "))),
        },
        ref options if options.iter().all(|option| [QUICK, JSON].contains(option)) => {
            let report = measure(if options.contains(&QUICK) { GENERATIONS_IF_QUICK } else { GENERATIONS });
            if options.contains(&JSON) {
                println!("{:#}", json!(report));
            } else {
                print!("{report}");
            }
        }
        _ => return refused("this bench takes --quick and --json, or --kernels, or --count KERNEL"),
    }
    ExitCode::SUCCESS
}

fn refused(why: &str) -> ExitCode {
    eprintln!("{why}");
    ExitCode::FAILURE
}

/// Pools of one thread, two, four and so on, and last of all that there are.
fn pools() -> Vec<ThreadPool> {
    let all = available_parallelism().map_or(1, usize::from);
    let doubled = std::iter::successors(Some(1), |threads| Some(2 * threads)).take_while(|threads| *threads < all);
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had");
    doubled.chain([all]).map(pool).collect()
}

fn measure(generations: usize) -> Report {
    let problem = thesis::problem(LENGTH_S);
    let (candidates, published) = thesis::candidates(&problem, POPULATION);
    let of_each = POPULATION * thesis::samples(&problem);
    let pools = pools();
    let costs = [Feedback::Osp, Feedback::Simulation].map(|feedback| {
        let engine = voigt::Kernel::new(&problem, feedback.into());
        let kernels = kernels(&problem, &candidates, &published, feedback, &engine, &pools);
        let off = compare(&kernels);
        let speeds = race::run(&kernels, generations, of_each);
        let row = |((kernel, speed), off): ((&Kernel<'_>, race::Speed), f64)| Row {
            kernel: kernel.name,
            threads: kernel.threads,
            sample_evaluations_per_s: speed.per_s,
            of_the_plain_loop: speed.ratio,
            cost_off_by_at_most: off,
        };
        Race { cost: feedback, kernels: kernels.iter().zip(speeds).zip(off).map(row).collect() }
    });
    Report {
        workload: Workload {
            candidates: POPULATION,
            generations,
            logs: problem.training().count(),
            samples: thesis::samples(&problem),
            parameters: candidates[0].named().len(),
            sample_evaluations: generations * of_each,
        },
        instructions: instructions(),
        costs: costs.into(),
        scaling: scaling::measure(&pools),
    }
}

/// The widest vector instructions that the machine has.
fn instructions() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if std::is_x86_feature_detected!("avx512f") {
            return "AVX-512";
        }
        if std::is_x86_feature_detected!("avx2") {
            return "AVX2";
        }
    }
    std::env::consts::ARCH
}

/// What is compared: the plain loop first.
fn kernels<'a>(
    problem: &'a Problem,
    candidates: &'a [VoigtParameters<f64>],
    published: &'a [Parameters],
    feedback: Feedback,
    engine: &'a voigt::Kernel<'a>,
    pools: &'a [ThreadPool],
) -> Vec<Kernel<'a>> {
    let (plain, one_step) = (Plain::new(problem), feedback == Feedback::Osp);
    let mut kernels = vec![
        Kernel {
            name: "plain loop, f64",
            threads: 1,
            bound: 0.0,
            costs: Box::new(move || candidates.iter().map(|candidate| plain.cost(candidate, one_step)).collect()),
        },
        Kernel {
            name: "recursion of estimator-core, f64",
            threads: 1,
            bound: OF_RECURSION,
            costs: Box::new(move || published.iter().map(|candidate| problem.cost(candidate, feedback)).collect()),
        },
    ];
    let mut ends: Vec<&ThreadPool> = pools.first().into_iter().chain(pools.last()).collect();
    ends.dedup_by_key(|pool| pool.current_num_threads());
    kernels.extend(ends.into_iter().map(|pool| Kernel {
        name: "engine, f64",
        threads: pool.current_num_threads(),
        bound: OF_ENGINE,
        costs: Box::new(move || pool.install(|| engine.costs(candidates))),
    }));
    kernels
}

/// By what part of itself each kernel's cost of a candidate differs from the first kernel's, at most.
fn compare(kernels: &[Kernel<'_>]) -> Vec<f64> {
    let plain = (kernels[0].costs)();
    let off = |kernel: &Kernel<'_>| {
        let of_each = (kernel.costs)().into_iter().zip(&plain).map(|(found, plain)| (found / plain - 1.0).abs());
        // By total order NaN is the largest, and refused below.
        let most = of_each.max_by(f64::total_cmp).unwrap_or(f64::NAN);
        let Kernel { name, bound, .. } = kernel;
        assert!(most <= *bound, "{name} differs from the plain loop by {most:.1e} of a cost, more than {bound:.1e}");
        most
    };
    kernels.iter().map(off).collect()
}
