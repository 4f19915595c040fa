import { spawn } from 'node:child_process';

/**
 * Runs a JavaScript tool in the foreground and resolves with its exit status. Ctrl-C reaches the tool from the
 * terminal itself; other requests to end are handed on, and a tool that ends because of one has status 0 here.
 */
export function runTool(script, args, options = {}) {
  const child = spawn(process.execPath, [script, ...args], { stdio: 'inherit', ...options });
  let isEnding = false;
  process.on('SIGINT', () => {
    isEnding = true;
  });
  for (const signal of ['SIGTERM', 'SIGHUP']) {
    process.on(signal, () => {
      isEnding = true;
      child.kill(signal);
    });
  }
  return new Promise((resolve, reject) => {
    child.once('error', reject);
    child.once('exit', (status) => resolve(isEnding ? 0 : (status ?? 1)));
  });
}
