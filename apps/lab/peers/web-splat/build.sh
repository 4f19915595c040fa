#!/usr/bin/env bash
# Compiles the renderer of the clone in ../sources/web-splat, or in the folder that is given, into its folder lab. It takes
# Rust with the target wasm32-unknown-unknown, and wasm-bindgen-cli in the version that Cargo.lock of the clone names.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
clone=$(realpath "${1:-../sources/web-splat}")
# The versions that its authors built with.
cp "$clone/Cargo.lock" .
RUSTFLAGS='--cfg getrandom_backend="wasm_js"' cargo build --release --target wasm32-unknown-unknown \
  --target-dir "$clone/target" --config "dependencies.web_splats.path='$clone'"
wasm-bindgen --target web --no-typescript --out-dir "$clone/lab" \
  "$clone/target/wasm32-unknown-unknown/release/web_splat_peer.wasm"
