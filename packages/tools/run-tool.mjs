import { spawn } from 'node:child_process';

/**
 * Runs a JavaScript tool in the foreground and forwards signals to it. Resolves with its exit
 * status, null if a signal ended it, and with whether a signal asked it to end.
 */
export function runTool(script, args, options = {}) {
  const child = spawn(process.execPath, [script, ...args], { stdio: 'inherit', ...options });
  let isEnding = false;
  for (const signal of ['SIGINT', 'SIGTERM', 'SIGHUP']) {
    process.on(signal, () => {
      isEnding = true;
      // A terminal sends Ctrl-C to all of its processes, including the tool.
      if (signal !== 'SIGINT' || !process.stdin.isTTY) child.kill(signal);
    });
  }
  return new Promise((resolve, reject) => {
    child.once('error', reject);
    child.once('exit', (status) => resolve({ status, wasAskedToEnd: isEnding }));
  });
}
