import { frameScene, perspectiveCamera } from '@websplatter/core';
import { measureFrames, orbitCameras } from '@websplatter/core/measure';
import { syntheticCamera } from '@websplatter/scenes';
import { type BenchOptions, parseBenchArguments } from './bench-options.ts';
import { type BenchReport, benchJson, benchText } from './bench-report.ts';
import { findBenchScene, loadTimed } from './bench-scene.ts';
import { type CameraChoice, prepareCamera } from './choose-camera.ts';
import { type Console, tenthsOf } from './console.ts';
import { findDetail } from './detail.ts';
import { currentCommit, describeMachine } from './machine.ts';
import { AUTO } from './options.ts';
import { checkOutputs } from './output-files.ts';

/** `websplatter bench SCENE|--synthetic N [--camera CAM.json] [--json]`. */
export async function bench(args: readonly string[], console: Console): Promise<void> {
  const options = parseBenchArguments(args);
  const report = await measure(options, console);
  console.out(options.isJson ? benchJson(report) : benchText(report));
}

async function measure(options: BenchOptions, console: Console): Promise<BenchReport> {
  const { widthPx, heightPx, frames, orbitDegrees, accuracy, accuracyLabel, detail } = options;
  const scene = await findBenchScene(options.scene);
  const { camera: cameraFile = AUTO } = options.cameraOptions ?? {};
  await checkOutputs([], cameraFile === AUTO ? scene.files : [cameraFile, ...scene.files]);
  const choice = await choiceOf(options);
  const { engine, cloud, load, notice, checkGpuErrors } = await loadTimed(scene, accuracy);
  try {
    if (notice !== null) console.err(`note: ${notice}\n`);
    const clouds = [{ cloud }];
    const { camera, found, notes } = await choice.choose((wishes) => frameScene(clouds, wishes));
    for (const note of notes) console.err(`note: ${note}\n`);
    const frame = { camera, clouds, widthPx, heightPx, detail };
    const { drawn } = await findDetail(engine.createView(), frame);
    const measurement = await measureFrames(engine, {
      clouds,
      cameras: orbitCameras(camera, cloud.robustBounds, { count: frames, sweepDegrees: orbitDegrees }),
      widthPx,
      heightPx,
      detail: drawn,
      onProgress: tenthsOf(console),
    });
    checkGpuErrors();
    return {
      scene: scene.name,
      isMade: scene.isMade,
      shDegree: cloud.shDegree,
      accuracyLabel,
      detail,
      ...(found && { camera: found }),
      orbitDegrees,
      load,
      measurement,
      commit: currentCommit(),
      machine: describeMachine(),
    };
  } finally {
    engine.destroy();
  }
}

async function choiceOf({ cameraOptions, widthPx, heightPx }: BenchOptions): Promise<CameraChoice> {
  const aspect = widthPx / heightPx;
  if (cameraOptions) return prepareCamera(cameraOptions, aspect);
  const camera = perspectiveCamera({ ...syntheticCamera, aspect });
  return { given: camera, choose: async () => ({ camera, found: null, notes: [] }) };
}
