import { spawn } from 'node:child_process';
import { createInterface } from 'node:readline';

/**
 * Runs a JavaScript tool in the foreground and forwards signals to it. Resolves with its exit
 * status, null if a signal ended it, and with whether a signal asked it to end.
 *
 * @param {string} script
 * @param {readonly string[]} args
 * @param {import('node:child_process').SpawnOptions} [options]
 * @param {(line: string) => void} [onLine] Takes what the tool prints, in place of the terminal.
 */
export function runTool(script, args, options = {}, onLine) {
  const stdio = onLine ? ['inherit', 'pipe', 'pipe'] : 'inherit';
  const child = spawn(process.execPath, [script, ...args], { stdio, ...options });
  for (const input of onLine ? [child.stdout, child.stderr] : [])
    createInterface({ input }).on('line', onLine);
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
    // After the last line.
    child.once('close', (status) => resolve({ status, wasAskedToEnd: isEnding }));
  });
}
