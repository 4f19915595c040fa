import { spawn } from 'node:child_process';

/**
 * Runs a JavaScript tool in the foreground. Requests to end reach it too. Resolves with its exit status, null where a
 * signal ended it, and whether it was asked to end.
 */
export function runTool(script, args, options = {}) {
  const child = spawn(process.execPath, [script, ...args], { stdio: 'inherit', ...options });
  let isEnding = false;
  for (const signal of ['SIGINT', 'SIGTERM', 'SIGHUP']) {
    process.on(signal, () => {
      isEnding = true;
      // Ctrl-C in a terminal goes to all of its processes, the tool included.
      if (signal !== 'SIGINT' || !process.stdin.isTTY) child.kill(signal);
    });
  }
  return new Promise((resolve, reject) => {
    child.once('error', reject);
    child.once('exit', (status) => resolve({ status, wasAskedToEnd: isEnding }));
  });
}
