//! What `ipctk` measures in repaired files.

use std::{fs, process::Command};

use untangled_testkit::{files::repository, process::untangled};

use super::grids;

/// The Python of the variable `TEST_PYTHON`, or that of the machine.
fn python() -> Command {
    Command::new(std::env::var_os("TEST_PYTHON").unwrap_or_else(|| "python3".into()))
}

#[test]
fn fix_with_gap_keeps_it_by_the_distances_of_ipctk_in_both_precisions() {
    let has_ipctk = python().args(["-c", "import ipctk, numpy"]).output().is_ok_and(|output| output.status.success());
    if !has_ipctk {
        eprintln!("SKIPPED: distances by ipctk: there is no Python with ipctk and numpy (pip install ipctk numpy)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grids.obj");
    fs::write(&path, grids(12, 0.0002)).unwrap();
    let script = repository().join("lab/scripts/gap_beside_ipctk.py");
    let output = python().arg(script).arg("--program").arg(untangled()).arg(&path).output().unwrap();
    let table = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<Vec<&str>> =
        table.lines().skip(2).map(|row| row.split('|').map(str::trim).collect::<Vec<_>>()).collect();
    assert_eq!(rows.len(), 2, "{table}{}", String::from_utf8_lossy(&output.stderr));
    for row in rows {
        // Least distances over the gap.
        for least in &row[8..10] {
            assert!(*least == "> 2" || least.parse::<f64>().unwrap() >= 1.0, "{table}");
        }
        assert!(row[4].parse::<usize>().unwrap() > 0 && row[5] == "0", "{table}");
    }
}
