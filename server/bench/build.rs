//! Puts the commit into the program: from `TYNDALL_COMMIT`, else from git, else "unknown".

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-env-changed=TYNDALL_COMMIT");
    println!("cargo::rerun-if-changed=build.rs");
    let from_git = || {
        let output = Command::new("git")
            .args(["rev-parse", "--short=12", "HEAD"])
            .output()
            .ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        // HEAD's log moves with every commit, checkout and rebase.
        let log = Command::new("git")
            .args([
                "rev-parse",
                "--path-format=absolute",
                "--git-path",
                "logs/HEAD",
            ])
            .output()
            .ok()?;
        if let Ok(path) = String::from_utf8(log.stdout) {
            println!("cargo::rerun-if-changed={}", path.trim());
        }
        output
            .status
            .success()
            .then(|| text.trim().to_owned())
            .filter(|text| !text.is_empty())
    };
    let commit = std::env::var("TYNDALL_COMMIT")
        .ok()
        .or_else(from_git)
        .unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=TYNDALL_COMMIT={commit}");
}
