import type { RootState } from '@react-three/fiber';
import { cameraFromMatrices, type EngineOptions, SplatEngine } from '@websplatter/core';
import { Matrix4 } from 'three';

/** A streamed scene for `drawnByEngine`. */
export interface EngineScene {
  readonly src: string;
  readonly position?: readonly [number, number, number];
}

/**
 * Draws streamed scenes with an engine of its own, without three and React, as a Canvas sees them.
 * Returns RGBA as on a black page, 8 bits each, once the frame is complete.
 */
export async function drawnByEngine(
  { camera, size }: Pick<RootState, 'camera' | 'size'>,
  scenes: readonly EngineScene[],
  options: EngineOptions,
): Promise<number[]> {
  const engine = await SplatEngine.create(options);
  const clouds = await Promise.all(
    scenes.map(async ({ src, position = [0, 0, 0] }) => ({
      cloud: await engine.load(src),
      modelMatrix: new Matrix4().makeTranslation(...position).elements,
    })),
  );
  const { matrixWorldInverse, projectionMatrix, near, far } = camera;
  const view = engine.createView();
  view.render({
    camera: cameraFromMatrices(matrixWorldInverse.elements, projectionMatrix.elements, { near, far }),
    clouds,
    widthPx: size.width,
    heightPx: size.height,
  });
  await view.whenComplete();
  const { data } = await view.readPixels();
  engine.destroy();
  return Array.from(data, (value, i) => (i % 4 === 3 ? 255 : Math.round(255 * Math.min(1, value))));
}
