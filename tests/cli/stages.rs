//! `trimray bench stages`.

use super::Bench;
use serde_json::Value;
use std::fs;

const FRAMES: &str = "--frames --resolution 32,24 --rays-per-pixel 2 --rays 100 --device cpu --repeat 2";

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

#[test]
fn every_stage_has_a_time() {
    let bench = Bench::new();
    let outcome = bench.run(&format!("bench stages cube.step --json {FRAMES}")).expect(0);
    let [line] = &lines(outcome.text())[..] else { panic!("{}", outcome.text()) };
    assert_eq!(
        (&line["faces"], &line["primary_rays"], &line["random_rays"]),
        (&6.into(), &1536.into(), &100.into())
    );
    for stage in [
        "read",
        "scan",
        "decode",
        "map",
        "import",
        "trims",
        "trim_trees",
        "nets",
        "leaves",
        "bvhs",
        "bake",
        "total",
        "write",
        "open",
        "first_ray",
        "upload",
        "compile",
        "first_frame",
        "frame",
        "primary",
        "random",
    ] {
        let [least, median] =
            ["seconds", "median_seconds"].map(|times| line[times][stage].as_f64().expect(stage));
        assert!(0.0 <= least && least <= median, "{stage}: {least} {median}");
    }
    let seconds = |stage: &str| line["seconds"][stage].as_f64().expect("a time");
    assert!(seconds("total") >= seconds("trims") + seconds("bake") && seconds("primary") > 0.0);
}

#[test]
fn a_run_is_compared_with_an_earlier_one() {
    let bench = Bench::new();
    let earlier = bench.run("bench stages cube.step --json").expect(0);
    fs::write(bench.path("earlier.jsonl"), &earlier.stdout).expect("written");
    let outcome = bench.run("bench stages cube.step --compare earlier.jsonl").expect(0);
    let row = outcome.text().lines().find(|line| line.contains("file to model")).expect("a row");
    let numbers = row.split_whitespace().filter(|word| word.parse::<f64>().is_ok()).count();
    // The least time, the median, the rate, the earlier time, their ratio.
    assert_eq!(numbers, 5, "{row}");
    fs::write(bench.path("wrong.jsonl"), "{}\n").expect("written");
    let outcome = bench.run("bench stages cube.step --compare wrong.jsonl").expect(1);
    assert!(outcome.stderr.contains("wrong.jsonl: line 1"), "{}", outcome.stderr);
}

#[test]
fn growth_is_told_and_plotted() {
    let bench = Bench::new();
    let outcome = bench.run("bench stages cube.step --grow 1,2,3 --repeat 1 --plot growth.svg").expect(0);
    assert!(outcome.text().contains("162 faces in 3 by 3 by 3 copies"), "{}", outcome.text());
    let exponents = outcome.text().split("exponent").nth(1).expect("a table").lines().skip(1);
    let trims = exponents.clone().find(|line| line.trim().starts_with("trims")).expect("a row");
    trims.split_whitespace().last().expect("a number").parse::<f64>().expect("an exponent");
    // A cube has no nets.
    assert_eq!(exponents.count(), 8);
    let svg = fs::read_to_string(bench.path("growth.svg")).expect("a plot");
    assert!(svg.contains(">trims<") && svg.contains(">faces<"), "{svg}");
}

#[test]
fn nonsense_is_refused() {
    let bench = Bench::new();
    for flags in ["--grow 0", "--warm-ups 2", "--frames --resolution 0,5", "--plot a.svg", "--repeat 0"] {
        bench.run(&format!("bench stages cube.step {flags}")).expect(2);
    }
}

#[test]
fn kernels_are_a_gpu_s() {
    let bench = Bench::new();
    let outcome = bench.run("bench stages cube.step --frames --kernels --device cpu --rays 10").expect(1);
    assert!(outcome.stderr.contains("no GPU"), "{}", outcome.stderr);
    if std::env::var_os("REQUIRE_GPU").is_none_or(|value| value != "1") {
        eprintln!("skipped: kernels on a GPU, without REQUIRE_GPU=1");
        return;
    }
    let load = "--frames --kernels --device gpu --resolution 32,24 --rays-per-pixel 2 --rays 1000 --repeat 1";
    let outcome = bench.run(&format!("bench stages cube.step --json {load}")).expect(0);
    let [line] = &lines(outcome.text())[..] else { panic!("{}", outcome.text()) };
    for stage in ["primary_kernel", "random_kernel"] {
        let held = |what: &str| line["held"][stage][what].as_u64().expect(stage);
        assert!(0 < held("hits") && held("hits") < held("rays"), "{stage}: {line}");
        assert!(line["seconds"][stage].as_f64().expect(stage) > 0.0);
    }
    assert!(line["seconds"].get("frame").is_none());
}
