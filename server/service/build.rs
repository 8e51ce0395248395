//! Puts the built page into the binary, or says in one line how to build it.

use std::path::Path;

fn main() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../web/dist");
    // While the page is missing, its later appearance must run this script again.
    println!(
        "cargo::rerun-if-changed={}",
        page.join("index.html").display()
    );
    if !page.join("index.html").is_file() {
        println!(
            "cargo::error=the page is not built: npm --prefix web ci && npm --prefix web run build; deploy/run.sh does it"
        );
        std::process::exit(1);
    }
    // Its log lines would come as compiler warnings.
    memory_serve::load_directory_with_embed(page, true);
}
