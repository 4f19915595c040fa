import { SparkRenderer, SplatMesh } from '@sparkjsdev/spark';
import * as THREE from 'three';
import { nextTask } from '../src/peers/adapter.ts';
import { threeWebGl } from './three-webgl.js';

/** Spark takes an order as good enough for a wider range of views; here it must be this view's. */
const MAX_DISTANCE = 1e-4;
const MIN_COSINE = 0.999999;

/**
 * Spark with one mesh on a canvas, and what all peers of it have.
 *
 * @param {import('@sparkjsdev/spark').SparkRendererOptions} rendererOptions
 * @param {import('@sparkjsdev/spark').SplatMeshOptions} meshOptions
 */
export function sparkScene(canvas, rendererOptions, meshOptions) {
  const { renderer, camera, setCamera } = threeWebGl(canvas);
  const scene = new THREE.Scene();
  const spark = new SparkRenderer({ renderer, ...rendererOptions });
  scene.add(spark);
  const mesh = new SplatMesh(meshOptions);
  scene.add(mesh);

  let orders = 0;
  const driveSort = spark.driveSort.bind(spark);
  spark.driveSort = () => {
    const wasSorting = spark.sorting;
    const driven = driveSort();
    if (!wasSorting && spark.sorting) orders++;
    return driven;
  };
  const position = new THREE.Vector3();
  const direction = new THREE.Vector3();
  const isOrdered = () => {
    camera.getWorldPosition(position);
    camera.getWorldDirection(direction);
    return (
      !spark.sorting &&
      !spark.sortDirty &&
      spark.activeSplats > 0 &&
      position.distanceTo(spark.sortedCenter) < MAX_DISTANCE &&
      direction.dot(spark.sortedDir) > MIN_COSINE
    );
  };
  return {
    spark,
    mesh,
    isOrdered,
    peer: {
      setCamera,
      draw: () => renderer.render(scene, camera),
      order: async () => {
        while (!isOrdered()) {
          if (!spark.sorting) await spark.update({ scene, camera });
          await nextTask();
        }
      },
      orders: () => orders,
      figures: () => ({ splats: spark.activeSplats }),
    },
  };
}
