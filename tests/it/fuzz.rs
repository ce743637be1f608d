//! A short run of the fuzzer of `examples/fuzz`: no case may panic, and every message has all its parts.

#[path = "../../examples/fuzz/mutate.rs"]
pub mod mutate;
#[path = "../../examples/fuzz/targets.rs"]
mod targets;

use crate::messages::assert_complete;

const CASES: u64 = 1000;
const SEED: u64 = 20_261_121;

#[test]
fn mutated_sessions_and_logs_of_every_format_give_messages_and_no_panic() {
    for target in targets::targets() {
        let (mut messages, mut read) = (0, 0);
        for case in 0..CASES {
            let outcome = target.read(&target.input(SEED, case));
            read += usize::from(outcome.is_read);
            for diagnostic in outcome.diagnostics {
                assert_complete(&diagnostic, &format!("{} case {case}", target.name));
                messages += 1;
            }
        }
        assert!(messages > 0, "{} is never refused", target.name);
        assert!(read > 0, "{} is never read", target.name);
    }
}
