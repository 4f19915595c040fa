#!/usr/bin/env bash
# Compiles the renderer of the clone in ../sources/web-splat, which may be a link, into the clone's folder lab. It takes Rust
# with the target wasm32-unknown-unknown, and wasm-bindgen-cli in the version that the clone's Cargo.lock names.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
clone=../sources/web-splat
# The versions that its authors built with.
cp "$clone/Cargo.lock" .
RUSTFLAGS='--cfg getrandom_backend="wasm_js"' cargo build --release --target wasm32-unknown-unknown --target-dir "$clone/target"
wasm-bindgen --target web --no-typescript --out-dir "$clone/lab" \
  "$clone/target/wasm32-unknown-unknown/release/web_splat_peer.wasm"
