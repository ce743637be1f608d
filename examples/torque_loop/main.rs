//! The loop on torque, tried on joints that are simulated from scratch: nothing in them, each effect of the joint, attachments elsewhere than drawn;
//! with and without lengths and arms taken by hand. Every joint has mountings, strengths, zeros, and a smooth misfit of the law.

mod bench;

use bench::{digest, table, trial};
use pipeline::stages::torque::diagnose::terms::Term;

const USAGE: &str = "\
The loop on simulated joints, as a table in Markdown.

cargo run --release --example torque_loop -- [OPTIONS]

  --seeds N      joints of each kind and case [default: 10]
  --first SEED   the first seed [default: 1]
  --only ID      joints with this effect alone, besides those with nothing in them; `none` for these alone
  --digest       the digest of the answers to four fixed joints, and nothing else
";

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let value = |name: &str| {
        let place = arguments.iter().position(|a| a == name)?;
        arguments.get(place + 1)
    };
    let number = |name: &str, otherwise: u64| {
        let given = value(name).and_then(|s| s.parse().ok());
        given.unwrap_or(otherwise)
    };
    let given = |name: &str| arguments.iter().any(|a| a == name);
    if given("--help") {
        print!("{USAGE}");
        return;
    }
    println!("{}", digest::line(&digest::answers()));
    if given("--digest") {
        return;
    }
    let (count, first) = (number("--seeds", 10), number("--first", 1));
    let seeds: Vec<u64> = (first..first + count).collect();
    let only = value("--only").cloned();
    let wanted = |form: &Term| only.as_ref().is_none_or(|id| id == form.id);
    println!("{}", table::document(&trial::outcomes(&seeds, &wanted)));
}
