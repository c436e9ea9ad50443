//! `trimray bench` of trims, of accuracy, and of run time against error.

use super::Bench;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A folder with the knob in it.
fn with_knob() -> Bench {
    let bench = Bench::new();
    let knob = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/knob/model.step");
    fs::copy(knob, bench.path("knob.step")).expect("copied");
    bench
}

/// Each row's fields by the names of the first line.
fn rows(text: &str) -> Vec<std::collections::HashMap<&str, &str>> {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("names").split(',').collect();
    lines.map(|line| names.iter().copied().zip(line.split(',')).collect()).collect()
}

#[test]
fn accuracy_is_told_for_each_precision() {
    let bench = with_knob();
    let few = "--rays 500 --csv accuracy.csv";
    let outcome = bench.run(&format!("bench accuracy knob.step {few}")).expect(0);
    assert!(outcome.text().contains("trims") && outcome.text().lines().count() == 4, "{}", outcome.text());
    let text = fs::read_to_string(bench.path("accuracy.csv")).expect("rows");
    let rows = rows(&text);
    let kinds: Vec<_> = rows.iter().map(|row| [row["precision"], row["against"]]).collect();
    assert_eq!(kinds, [["f32", "tracer"], ["f32", "total"], ["f64", "tracer"]]);
    for row in &rows {
        let wrong = ["missed", "phantom", "misclassified"].map(|name| row[name]);
        assert_eq!(wrong, ["0"; 3], "{row:?}");
        assert!(row["certain"].parse::<u64>().expect("a count") > 490, "{row:?}");
        assert!(row["uv_max"].parse::<f64>().expect("a number") < 1e-4, "{row:?}");
    }
    let outcome = bench.run("bench accuracy knob.step --rays 100 --exactness fast --json").expect(0);
    let line: Value = serde_json::from_str(outcome.text().lines().next().expect("a line")).expect("JSON");
    assert_eq!((&line["rays"], &line["misclassified"]), (&100.into(), &0.into()), "{line}");
    assert!(line["hits"].as_u64().expect("a count") > 20, "{line}");
    bench.run("bench accuracy knob.step --exactness much").expect(2);
}

#[test]
fn leaks_tell_rays_that_others_answer() {
    let bench = with_knob();
    let outcome = bench.run("bench leaks knob.step --rays 200 --precision f32 --json").expect(0);
    let line: Value = serde_json::from_str(outcome.text()).expect("JSON");
    assert_eq!((&line["aimed"]["odd"], &line["aimed"]["beside"]), (&0.into(), &0.into()), "{line}");
    let outcome = bench.run("bench stress --only same-egg --rays 20 --precision f64").expect(0);
    assert!(outcome.text().contains("restart"), "{}", outcome.text());
}

#[test]
fn work_sweeps_every_setting() {
    let bench = with_knob();
    bench.run("bench work knob.step --rays 200 --csv work.csv --plot work.svg").expect(0);
    let text = fs::read_to_string(bench.path("work.csv")).expect("rows");
    let rows = rows(&text);
    let count = |series: &str| rows.iter().filter(|row| row["series"] == series).count();
    let series = ["exact f32", "exact f64", "Newton's stop", "trim method"];
    assert_eq!(series.map(count), [5, 1, 5, 4], "{text}");
    assert!(fs::read_to_string(bench.path("work.svg")).expect("a plot").contains("Newton's stop"));
    bench.run("bench work knob.step --rival absent.csv --rays 10").expect(1);
}

#[test]
fn the_trimming_study_has_a_row_for_each_method() {
    let bench = with_knob();
    let few = "--rays 200 --resolution 16,9 --repeat 1";
    let outcome = bench.run(&format!("bench trim knob.step {few} --csv rows.csv")).expect(0);
    for label in ["absolute", "1-LC ", "3-HS ", "13-KCS[SF19] ", "29-KCS+RBEM ", "30-PACKED "] {
        assert_eq!(outcome.text().lines().filter(|line| line.starts_with(label)).count(), 1, "{label}");
    }
    assert!(!outcome.text().contains("otherwise"), "{}", outcome.text());
    let rows = fs::read_to_string(bench.path("rows.csv")).expect("rows");
    assert_eq!(rows.lines().count(), 1 + 2 * 31);
    let outcome = bench.run(&format!("bench trim knob.step {few} --methods 1,packed --json")).expect(0);
    let line: Value = serde_json::from_str(outcome.text()).expect("JSON");
    assert_eq!(line["methods"].as_array().expect("methods").len(), 2);
    assert!(line["methods"][0]["random"]["queries"].as_u64().expect("a count") > 0);
    let outcome = bench.run("bench trim knob.step --check 2000").expect(0);
    assert!(outcome.text().contains("31 methods, 0 wrong answers"), "{}", outcome.text());
    let degrees = format!("bench trim knob.step {few} --degrees 2,5 --methods 3,packed --plot plot.svg");
    let outcome = bench.run(&degrees).expect(0);
    assert!(outcome.text().contains("30-PACKED, lines kept"), "{}", outcome.text());
    assert!(fs::read_to_string(bench.path("plot.svg")).expect("a plot").contains("<polyline"));
    bench.run("bench trim knob.step --plot plot.svg").expect(2);
}
