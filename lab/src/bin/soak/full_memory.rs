//! A `/dev/shm` that is too small: a refusal in words, never SIGBUS. Runs in a mount namespace of its own, with 96 MB of shared memory.

use std::{
    io::Write,
    process::{Command, Stdio},
    time::Duration,
};

use rustix::process::Signal;
use untangled_client::{RegisterError, RequestError, Status};
use untangled_transport::memory;

use super::{
    faults::Row,
    processes::{Daemon, Programs, TestDomain},
    scene::Scene,
};

/// What the inner process says when all went well.
const DONE: &str = "full-memory: ";

/// Runs [`inner`] where `/dev/shm` is small; nothing where this user can't make such a place. `program` must lead to `inner`.
pub fn full_memory(program: Command) -> Option<Row> {
    let mut outer = Command::new("unshare");
    if !rustix::process::getuid().is_root() {
        outer.args(["--user", "--map-root-user"]);
    }
    outer.args(["--mount", "sh", "-c", "mount -t tmpfs -o size=96m tmpfs /dev/shm || exit 77; exec \"$0\" \"$@\""]);
    outer.arg(program.get_program()).args(program.get_args());
    outer.envs(program.get_envs().filter_map(|(name, value)| Some((name, value?))));
    // In the namespace this user is root, but root's own folder of domains is not this user's to make.
    let runtime = format!("/tmp/full-memory-{}", std::process::id());
    outer.env("XDG_RUNTIME_DIR", &runtime);
    let output = outer.stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let _ = std::fs::remove_dir_all(&runtime);
    let output = output.ok()?;
    let text = String::from_utf8_lossy(&output.stdout);
    match (text.lines().find_map(|line| Some(line.split_once(DONE)?.1)), output.status.code()) {
        (Some(line), Some(0)) => {
            let (num_tries, note) = line.split_once(' ')?;
            let num_tries = num_tries.parse().ok()?;
            Some(Row {
                what: "`/dev/shm` too small or filled by others".into(),
                num_tries,
                note: note.into(),
                ..Row::default()
            })
        }
        // No right to a namespace or to mount, or no such program.
        (None, Some(77 | 1 | 126 | 127)) if !text.contains("panicked") => None,
        (_, code) => panic!("the process with little shared memory ended with {code:?} (none is a signal): {text}"),
    }
}

/// Sessions until there is no room, then the rest filled by somebody else: what is open goes on, what is new is refused.
pub fn inner(programs: Programs) {
    let domain = TestDomain::new();
    let mut daemon = Daemon::start(programs, &domain, &[]);
    let client = domain.connect();
    let scene = Scene::new(5000);
    let huge = Scene::new(100_000);
    let mut num_refused = 0;
    let refused = |result: Result<_, RegisterError>| match result {
        Err(RegisterError::Request(
            RequestError::Refused { status: Status::NotEnoughMemory, .. } | RequestError::NotEnoughMemory { .. },
        )) => true,
        Err(error) => panic!("{error}"),
        Ok::<untangled_client::Session, _>(_) => false,
    };
    let mut sessions = Vec::new();
    loop {
        num_refused += u64::from(refused(client.register(huge.registration())));
        match client.register(scene.registration()) {
            Ok(session) => sessions.push(session),
            error => {
                assert!(refused(error));
                num_refused += 1;
                break;
            }
        }
    }
    assert!(!sessions.is_empty() && num_refused > 1, "the test shows nothing");
    // Somebody else takes what is left, to the last page.
    let filler = format!("{}/filler-{}", memory::FOLDER, std::process::id());
    let mut file = std::fs::File::create(&filler).expect("a file");
    let page = [1; 4096];
    while file.write_all(&page).is_ok() {}
    let mut num_frames = 0;
    for _ in 0..30 {
        for session in &mut sessions {
            let correction = scene.exchange(session, Duration::from_secs(30)).expect("open sessions go on");
            assert!(scene.is_right(&correction));
            num_frames += 1;
        }
    }
    for _ in 0..10 {
        num_refused += u64::from(refused(client.register(scene.registration())));
    }
    assert!(daemon.is_running());
    drop(std::fs::remove_file(&filler));
    let num_open = sessions.len();
    drop(sessions);
    super::processes::eventually("there is room again", || client.register(scene.registration()).is_ok());
    drop(client);
    assert!(daemon.stop(Signal::TERM).success());
    println!(
        "{DONE}{num_refused} {num_refused} registrations refused in words; {num_open} open sessions exchanged {num_frames} frames with not a page left; there was room again afterwards"
    );
}
