import { OrbitControls } from '@react-three/drei';
import { invalidate, type ThreeEvent, useFrame, useThree } from '@react-three/fiber';
import { SplatCanvas, type SplatCloudObject, Splats } from '@websplatter/react';
import { makeSplatData } from '@websplatter/react/own-data';
import { splatColor, splatNode, splatPosition, splatRow, splatScale } from '@websplatter/react/tsl';
import { useEffect, useRef, useState } from 'react';
import { color, Fn, float, instancedArray, instanceIndex, mix, step, uniform, vec3 } from 'three/tsl';
import type { Node, WebGPURenderer } from 'three/webgpu';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

/** Cells around the ring and around its tube; a cell is a row of the arrays. */
const [AROUND_RING, AROUND_TUBE] = [192, 72];
const CELLS = AROUND_RING * AROUND_TUBE;
const TUBE_RADIUS = 0.42;
const GENERATIONS_AT_REST = 60;
const GENERATIONS_PER_S = 12;
/** Five cells that wander. */
const GLIDER = [
  [1, 0],
  [2, 1],
  [0, 2],
  [1, 2],
  [2, 2],
];

/** A splat for each cell, on a ring. */
function ring() {
  const positions = new Float32Array(3 * CELLS);
  const colors = new Float32Array(3 * CELLS);
  for (let row = 0; row < CELLS; row++) {
    const longitude = (2 * Math.PI * (row % AROUND_RING)) / AROUND_RING;
    const latitude = (2 * Math.PI * Math.floor(row / AROUND_RING)) / AROUND_TUBE;
    const radius = 1 + TUBE_RADIUS * Math.cos(latitude);
    const height = TUBE_RADIUS * Math.sin(latitude);
    positions.set([radius * Math.cos(longitude), height, radius * Math.sin(longitude)], 3 * row);
    const light = 0.16 + 0.09 * Math.sin(latitude);
    colors.set([0.8 * light, light, 1.5 * light], 3 * row);
  }
  return { positions, colors, scales: new Float32Array(3 * CELLS).fill(0.016) };
}

/** One cell in four lives: the same ones in each run. */
function firstGeneration(): Float32Array {
  let state = 7;
  return Float32Array.from({ length: CELLS }, () => {
    state = (16807 * state) % 2147483647;
    return state % 4 === 0 ? 1 : 0;
  });
}

// A value per row: 1 for a cell that lives, less the longer it has been dead.
const cells = instancedArray(firstGeneration(), 'float');
const next = instancedArray(CELLS, 'float');

/** The cell some steps away, on a surface without an edge. */
function cellFrom(row: Node<'uint'>, [x, y]: readonly number[]) {
  const column = row
    .mod(AROUND_RING)
    .add(x + AROUND_RING)
    .mod(AROUND_RING);
  const line = row
    .div(AROUND_RING)
    .add(y + AROUND_TUBE)
    .mod(AROUND_TUBE);
  return cells.element(line.mul(AROUND_RING).add(column));
}

const live = Fn(() => {
  const neighbours = float(0).toVar();
  for (const y of [-1, 0, 1])
    for (const x of [-1, 0, 1])
      if (x !== 0 || y !== 0) neighbours.addAssign(step(1, cellFrom(instanceIndex, [x, y])));
  const value = cells.element(instanceIndex);
  const lives = neighbours.equal(3).or(neighbours.equal(2).and(value.greaterThanEqual(1)));
  next.element(instanceIndex).assign(lives.select(1, value.mul(0.88)));
})().compute(CELLS);
const age = Fn(() => {
  cells.element(instanceIndex).assign(next.element(instanceIndex));
})().compute(CELLS);
const clear = Fn(() => {
  cells.element(instanceIndex).assign(0);
})().compute(CELLS);
const pickedRow = uniform(0, 'uint');
const setGlider = Fn(() => {
  for (const cell of GLIDER) cellFrom(pickedRow, cell).assign(1);
})().compute(1);

// The hook reads the value of the splat's own row, wherever the engine has stored the splat.
const glow = cells.element(splatRow);
const middle = splatPosition.mul(vec3(1, 0, 1)).normalize();
const outward = splatPosition.sub(middle).normalize();
const alive = splatNode({
  position: splatPosition.add(outward.mul(glow.mul(0.03))),
  scale: splatScale.mul(glow.mul(0.25).add(1)),
  color: mix(splatColor, mix(color('#ff3d2e'), color('#ffd76a'), step(1, glow)), glow),
  reach: { displacement: 0.03, growth: 1.25 },
});
const effects = [alive];

export default function TslStorage() {
  const [isPlaying, setPlaying] = useState(!prefersStillness);
  const [clearings, setClearings] = useState(0);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0, 2.05, 2.5], fov: 50, near: 0.05 }}>
        <color attach="background" args={['#05060d']} />
        <Board isPlaying={isPlaying} clearings={clearings} />
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <span>Click to set a glider.</span>
        <button type="button" onClick={() => setClearings(clearings + 1)}>
          Clear
        </button>
        <label>
          <input type="checkbox" checked={isPlaying} onChange={() => setPlaying(!isPlaying)} /> Playing
        </label>
      </form>
    </>
  );
}

/** @param clearings kills all cells when it grows. */
function Board({ isPlaying, clearings }: { isPlaying: boolean; clearings: number }) {
  const renderer = useThree(({ gl }) => gl as unknown as WebGPURenderer);
  const splats = useRef<SplatCloudObject>(null);
  const dueS = useRef(0);
  const [data] = useState(() => {
    for (let i = 0; i < GENERATIONS_AT_REST; i++) renderer.compute([live, age]);
    return makeSplatData(ring());
  });
  useEffect(() => {
    if (clearings > 0) renderer.compute(clear);
    invalidate();
  }, [renderer, clearings]);
  useFrame((_state, elapsedS) => {
    if (!isPlaying) return;
    dueS.current += Math.min(elapsedS, 0.1);
    for (; dueS.current > 0; dueS.current -= 1 / GENERATIONS_PER_S) renderer.compute([live, age]);
    invalidate();
  });
  useEffect(() => {
    if (isPlaying) invalidate();
  }, [isPlaying]);
  const pick = async (event: ThreeEvent<MouseEvent>) => {
    const hit = await splats.current?.pickAt(event);
    if (!hit) return;
    pickedRow.value = hit.row;
    renderer.compute(setGlider);
    invalidate();
  };
  return <Splats ref={splats} src={data} effects={effects} onClick={pick} />;
}
