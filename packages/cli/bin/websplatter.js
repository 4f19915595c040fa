#!/usr/bin/env node
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const built = new URL('../dist/main.js', import.meta.url);
if (!existsSync(built)) {
  console.error('websplatter: building, as this is its first run here …');
  const build = fileURLToPath(new URL('../../tools/build.mjs', import.meta.url));
  // Standard output is for the command itself.
  const { status } = spawnSync(process.execPath, [build, '--packages'], { stdio: ['ignore', 2, 2] });
  if (status !== 0) {
    console.error('websplatter: it could not be built; see above');
    process.exit(2);
  }
}
const { run } = await import(built.href);
await run(process.argv.slice(2));
