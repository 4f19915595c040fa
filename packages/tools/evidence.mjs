import { execFileSync } from 'node:child_process';
import os from 'node:os';

// Runs of tools as evidence for the documentation: `evidence/NAME.json`, whose fields are those of
// apps/docs/src/build/evidence.ts. Title and conclusion are for people to write.

/** The commit of a checkout, with `+changes` where tracked files differ from it; null outside of git. */
export function commitOf(cwd) {
  const git = (...args) => execFileSync('git', args, { cwd, encoding: 'utf8', stdio: 'pipe' }).trim();
  try {
    const isChanged = git('status', '--porcelain', '--untracked-files=no') !== '';
    return `${git('rev-parse', '--short=12', 'HEAD')}${isChanged ? '+changes' : ''}`;
  } catch {
    // The folder is outside of git.
    return null;
  }
}

/**
 * Evidence of a run on this machine now.
 *
 * @param run its `command`, and what is known of its `commit` and `adapter`.
 * @param tables each with `caption`, `columns` and `rows` of text, numbers and null.
 * @param remarks sentences with figures that no table has.
 */
export function evidenceOf({ command, commit, adapter }, tables, remarks = []) {
  const date = new Date().toISOString().slice(0, 10);
  const cpus = os.cpus();
  return {
    title: `${command.split(' ').slice(0, 3).join(' ')}, ${date}`,
    conclusion: 'No conclusion has been drawn yet.',
    run: {
      ...(commit && { commit }),
      date,
      machine: `${cpus.length} × ${cpus[0]?.model ?? 'unknown'}, ${Math.round(os.totalmem() / 2 ** 30)} GiB; ${os.type()}`,
      ...(adapter && { adapter }),
      browser: `Dawn in Node ${process.versions.node}`,
      command,
    },
    tables,
    remarks: [...new Set(remarks)],
  };
}

/** Tables of what `websplatter bench --json` prints. */
export function benchTables({ scene, measurement }) {
  const { gpuMs, stageMs, wallClockMs, passes, frames, widthPx, heightPx } = measurement;
  const row = (name, spread) => [name, spread.median, spread.p99];
  const times = [
    ...Object.entries(stageMs ?? {}).map(([stage, spread]) => row(stage, spread)),
    ...(gpuMs ? [row('frame, GPU', gpuMs)] : []),
    row('frame, wall clock', wallClockMs),
  ];
  const columns = ['median, ms', 'P99, ms'];
  const where = `${scene}, ${measurement.loadedSplats} splats, ${widthPx} × ${heightPx} px, ${frames} frames`;
  const ofPasses = passes?.map(({ part, stage, timeMs }) => [part, stage, timeMs.median, timeMs.p99]);
  return [
    { caption: where, columns: ['part', ...columns], rows: times },
    ...(ofPasses ? [{ caption: 'Passes', columns: ['part', 'stage', ...columns], rows: ofPasses }] : []),
  ];
}

/** Tables of what `websplatter accuracy --json` prints. */
export function accuracyTables({ scenes, distance, widthPx, heightPx, frames, points }) {
  return [
    {
      caption: `${scenes.join(', ')} from ${distance} times the distance, ${widthPx} × ${heightPx} px, ${frames} frames`,
      columns: ['settings', 'splats', 'PSNR, dB', 'largest error', 'SSIM', 'median, ms', 'P99, ms', 'bytes'],
      rows: points.map(({ name, splats, error, timeMs: { total }, bytes }) => [
        ...[name, splats, error.psnrDb ?? 'equal', error.maxError, error.ssim],
        ...[total.median, total.p99, bytes],
      ]),
    },
  ];
}
