#!/usr/bin/env node
import { existsSync } from 'node:fs';

const built = new URL('../dist/main.js', import.meta.url);
if (existsSync(built)) {
  const { run } = await import(built.href);
  await run(process.argv.slice(2));
} else {
  console.error('websplatter: not built yet; run `npm run build` first');
  process.exitCode = 2;
}
