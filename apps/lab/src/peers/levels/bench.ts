import { execFileSync } from 'node:child_process';
import { readFile, writeFile } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import { ACCURACY_PRESETS, encodePly, readSplats, type SplatCloud, SplatEngine } from '@websplatter/core';
import { antialias } from '@websplatter/core/effects';
import { measureFrames, orbitCameras } from '@websplatter/core/measure';
import { packSet } from '@websplatter/core/own-data';
import { createNodeGpu, openFile } from '@websplatter/node';
import { commitOf } from '@websplatter/tools/commit';
import { sparkLevels } from '../../../peers/spark-levels.js';
import type { NodeBench } from '../runner/bench.ts';
import { evidenceOf } from '../runner/evidence.ts';
import { peersFolder } from '../runner/peer-list.ts';
import { machineText, markdownTable, type RunFacts, reportFacts } from '../runner/report.ts';
import { readScene, sceneFiles } from '../runner/scenes.ts';
import type { Levels } from './levels.ts';
import { type LevelsOptions, readOptions, USAGE } from './options.ts';
import {
  comparePictures,
  DILATIONS_PX2,
  drawTruths,
  type Measured,
  measuredTables,
  SIZE,
} from './pictures.ts';

/** Levels of detail of this project and of others. */
const bench: NodeBench<LevelsOptions> = {
  script: 'bench:levels',
  usage: USAGE,
  readOptions,
  async measure(options, { workFolder, say, commandLine }) {
    const { adapter, subject, parts } = await measureLevels(options, workFolder, say);
    const facts: RunFacts = {
      date: new Date().toISOString(),
      command: [commandLine.name, ...commandLine.args].join(' '),
      commit: commitOf(peersFolder),
      machine: machineText(),
      browser: `Dawn in Node ${process.versions.node}`,
      adapter,
    };
    const tables = parts.map(({ rows }) => markdownTable(rows, 1).join('\n'));
    const { evidenceFile } = options;
    return {
      text: [reportFacts(facts).join('\n'), `### ${subject}`, ...tables].join('\n\n'),
      files: new Map(evidenceFile === null ? [] : [[evidenceFile, evidenceOf(facts, parts, [subject])]]),
      hasFailures: false,
    };
  },
};
export default bench;

/** Measures the levels of every project, with files in `folder`. */
async function measureLevels(options: LevelsOptions, folder: string, say: (line: string) => void) {
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
  // Cameras by which choosing is timed.
  const turn = orbitCameras(truths[0][0].camera, whole.robustBounds, { count: 24, sweepDegrees: 360 });

  async function* everyLevels() {
    yield everySplat(whole);
    yield* ownLevels(engine, whole, addBalanced);
    yield* sparkLevels(engine, whole, plyFile);
    yield* decimatedLevels(engine, plyFile, options.shares);
  }
  const measured: Measured[] = [];
  for await (const levels of everyLevels()) {
    say(`${levels.name} …`);
    const ofShares = [];
    for (const share of options.shares) {
      const pictures = new Map<number, Awaited<ReturnType<typeof comparePictures>>>();
      for (const dilationPx2 of DILATIONS_PX2)
        pictures.set(dilationPx2, await comparePictures(view, truths, levels, share, dilationPx2));
      ofShares.push({ share, choiceMs: await levels.choiceMs(turn, share), pictures });
    }
    measured.push({ name: levels.name, buildMs: levels.buildMs, ofShares });
  }
  engine.destroy();

  const { dependencies } = JSON.parse(await readFile(join(peersFolder, 'package.json'), 'utf8'));
  const versions = `Spark ${dependencies['@sparkjsdev/spark']}, splat-transform ${dependencies['@playcanvas/splat-transform']}`;
  const subject = `${name}: ${set.count} splats, harmonics of degree ${set.harmonics.degree}, ${truths.length} cameras; ${versions}`;
  return { adapter: label, subject, parts: measuredTables(measured) };
}

/** The whole scene as it is drawn: no levels can be expected to come nearer to filtered pictures. */
function everySplat(whole: SplatCloud): Levels {
  return {
    name: 'every splat',
    buildMs: [],
    choose: async () => ({ instance: { cloud: whole }, detail: 'full' }),
    choiceMs: async () => null,
  };
}

/** Stages that frames only have to choose a cut. */
const CUT_STAGES = ['cut-cells', 'cut-count', 'plan-cut', 'cut-splats'];

/** This project's levels: pictures are of `whole`, times of clouds that `addBalanced` adds. */
async function* ownLevels(
  engine: SplatEngine,
  whole: SplatCloud,
  addBalanced: () => SplatCloud,
): AsyncGenerator<Levels> {
  const buildMs: number[] = [];
  const build = async () => {
    const cloud = addBalanced();
    await cloud.uploaded;
    await engine.device.queue.onSubmittedWorkDone();
    const startedMs = performance.now();
    await cloud.makeLevels();
    await engine.device.queue.onSubmittedWorkDone();
    buildMs.push(performance.now() - startedMs);
    return cloud;
  };
  // The first time with shaders to compile.
  (await build()).destroy();
  const cloud = await build();
  await whole.makeLevels();
  const budgetOf = (share: number) => ({ maxSplats: Math.round(share * whole.count) });
  yield {
    name: 'WebSplatter',
    buildMs,
    choose: async (_, share) => ({ instance: { cloud: whole }, detail: budgetOf(share) }),
    async choiceMs(cameras, share) {
      const clouds = [{ cloud, effects: [antialias()] }];
      const frame = { clouds, ...SIZE, accuracy: 'balanced' as const, cameras, detail: budgetOf(share) };
      const { passes } = await measureFrames(engine, frame);
      const cut = passes?.filter(({ stage }) => CUT_STAGES.includes(stage));
      return cut?.reduce((sum, { timeMs }) => sum + timeMs.median, 0) ?? null;
    },
  };
  cloud.destroy();
}

const COMMAND = join(peersFolder, 'node_modules/@playcanvas/splat-transform/bin/cli.mjs');

/**
 * Files with each share of the splats, as PlayCanvas streams them. Times of building include reading
 * and writing files, as splat-transform's command does.
 */
async function* decimatedLevels(
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
