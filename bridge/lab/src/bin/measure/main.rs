//! What the bridge costs, and how much it carries. `measure lockstep|rate|ways|hosts|same|capacity`, each with numbers.
//!
//! Run it as root for network namespaces; without them it says so and measures over loopback.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a measurement, which fails by panicking")]
#![allow(clippy::cast_precision_loss, reason = "times and counts")]

mod link;
mod load;
mod setting;
mod trips;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, default: u64| arguments.get(k).map_or(default, |text| text.parse().unwrap());
    match arguments.first().map(String::as_str) {
        Some("delay") => link::delay(&arguments[1..]),
        Some("lockstep") => trips::lockstep(number(1, 1000)),
        Some("rate") => trips::rate(number(1, 30)),
        Some("same") => load::same(number(1, 10_000)),
        Some("ways") => trips::ways(number(1, 1000)),
        Some("hosts") => trips::hosts(number(1, 1000)),
        Some("capacity") => {
            let rate = arguments.get(3).map_or("1gbit", String::as_str);
            load::capacity(usize::try_from(number(1, 1)).unwrap(), number(2, 16), rate, arguments.get(4).is_some());
        }
        _ => println!(
            "measure lockstep [FRAMES] | rate [SECONDS] | ways [FRAMES] | hosts [FRAMES] | same [FRAMES] | \
             capacity [DAEMONS] [SESSIONS] [RATE] [apart]"
        ),
    }
}
