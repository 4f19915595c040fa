import { readFile, writeFile } from 'node:fs/promises';
import os from 'node:os';
import { join } from 'node:path';
import { ACCURACY_PRESETS, encodePly, readSplats, SplatEngine } from '@websplatter/core';
import { orbitCameras } from '@websplatter/core/measure';
import { packSet } from '@websplatter/core/own-data';
import { createNodeGpu, openFile } from '@websplatter/node';
import { commitOf } from '@websplatter/tools/commit';
import { sparkLevels } from '../../../peers/spark-levels.js';
import type { NodeBench } from '../runner/bench.ts';
import { peersFolder } from '../runner/peer-list.ts';
import { readScene, sceneFiles } from '../runner/scenes.ts';
import { decimatedLevels } from './decimated.ts';
import { type LevelsOptions, readOptions, USAGE } from './options.ts';
import { ownLevels } from './own-levels.ts';
import { comparePictures, drawTruths } from './pictures.ts';
import { type Measured, measuredTables } from './table.ts';

/** Levels of detail beside those of other projects. */
const bench: NodeBench<LevelsOptions> = {
  script: 'bench:levels',
  usage: USAGE,
  readOptions,
  measure: async (options, { workFolder, say }) => ({
    text: await measureLevels(options, workFolder, say),
    json: null,
    hasFailures: false,
  }),
};
export default bench;

/** Measures levels of our own, and then those of others, with files in `folder`; returns Markdown. */
async function measureLevels(
  options: LevelsOptions,
  folder: string,
  say: (line: string) => void,
): Promise<string> {
  const [file] = await sceneFiles(options, folder);
  const { name, cameras } = await readScene(file, null);
  const read = await readSplats(await openFile(file), { name, shPrecision: 'f32' });
  const flat = { degree: 0, coefficients: new Float32Array() } as const;
  const set = options.isFlat ? { ...read, harmonics: flat } : read;
  const plyFile = join(folder, 'scene.ply');
  await writeFile(plyFile, encodePly(set));

  const { gpu, adapter, label } = await createNodeGpu();
  const engine = await SplatEngine.create({ gpu, adapter, accuracy: 'reference' });
  const view = engine.createView();
  const whole = engine.add(set);
  const addBalanced = () => engine.addPacked(packSet(set, ACCURACY_PRESETS.balanced));
  const truths = [];
  for (const place of cameras.slice(0, options.views))
    truths.push(await drawTruths(view, { cloud: whole }, place));
  // By which choosing is timed.
  const turn = orbitCameras(truths[0][0].camera, whole.robustBounds, { count: 24, sweepDegrees: 360 });

  async function* everyLevels() {
    yield* ownLevels(engine, whole, addBalanced);
    yield* sparkLevels(engine, whole, plyFile);
    yield* decimatedLevels(engine, plyFile, options.shares);
  }
  const measured: Measured[] = [];
  for await (const levels of everyLevels()) {
    say(`${levels.name} …`);
    const ofShares = [];
    for (const share of options.shares) {
      const pictures = await comparePictures(view, truths, levels, share);
      ofShares.push({ share, choiceMs: await levels.choiceMs(turn, share), pictures });
    }
    measured.push({ name: levels.name, buildMs: levels.buildMs, ofShares });
  }
  engine.destroy();

  const { dependencies } = JSON.parse(await readFile(join(peersFolder, 'package.json'), 'utf8'));
  const versions = `Spark ${dependencies['@sparkjsdev/spark']}, splat-transform ${dependencies['@playcanvas/splat-transform']}`;
  return [
    `${new Date().toISOString()}, commit ${commitOf(peersFolder) ?? 'unknown'}`,
    `${label}; ${os.cpus()[0].model}; ${versions}`,
    `### ${name}: ${set.count} splats, harmonics of degree ${set.harmonics.degree}, ${truths.length} cameras`,
    ...measuredTables(measured),
  ].join('\n\n');
}
