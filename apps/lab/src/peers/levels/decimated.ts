import { execFileSync } from 'node:child_process';
import { dirname, join } from 'node:path';
import { readSplats, type SplatEngine } from '@websplatter/core';
import { openFile } from '@websplatter/node';
import { peersFolder } from '../runner/peer-list.ts';
import type { Levels } from './levels.ts';

const COMMAND = join(peersFolder, 'node_modules/@playcanvas/splat-transform/bin/cli.mjs');

/**
 * Files with each share of the splats, as PlayCanvas streams them: times of building are those of
 * splat-transform's command, which reads and writes files.
 */
export async function* decimatedLevels(
  engine: SplatEngine,
  plyFile: string,
  shares: readonly number[],
): AsyncGenerator<Levels> {
  for (const [name, option] of Object.entries({ uniform: '--decimate', adaptive: '--decimate-adaptive' })) {
    const fileOf = (share: number) => join(dirname(plyFile), `${name}-${share}.ply`);
    const buildMs = shares.map((share) => {
      const percent = `${Math.round(100 * share)}%`;
      const startedMs = performance.now();
      const args = [COMMAND, '--gpu', 'cpu', plyFile, option, percent, fileOf(share)];
      execFileSync(process.execPath, args, { stdio: 'pipe' });
      return performance.now() - startedMs;
    });
    yield {
      name: `splat-transform ${name}`,
      buildMs,
      async choose(_, share) {
        const file = fileOf(share);
        const cloud = engine.add(await readSplats(await openFile(file), { name: file, shPrecision: 'f32' }));
        return { instance: { cloud }, detail: 'full', end: () => cloud.destroy() };
      },
      choiceMs: async () => null,
    };
  }
}
