/**
 * Returns what `action` returns. Fails if this process spends more than `mostMs` of CPU time on it: unlike time
 * by the clock, that does not grow while other processes keep the machine busy.
 */
export async function withinCpuTime<Result>(
  mostMs: number,
  action: () => Result | Promise<Result>,
): Promise<Result> {
  const start = process.cpuUsage();
  const result = await action();
  const { user, system } = process.cpuUsage(start);
  const cpuMs = (user + system) / 1000;
  if (cpuMs > mostMs)
    throw new Error(`It took ${cpuMs.toFixed(0)} ms of CPU time; at most ${mostMs} ms are usual.`);
  return result;
}
