import { OrbitControls } from '@react-three/drei';
import { useFrame, useThree } from '@react-three/fiber';
import { SplatCanvas, Splats } from '@websplatter/react';
import { makeGpuSplats } from '@websplatter/react/own-data';
import { useEffect, useState } from 'react';
import { Fn, instancedArray, instanceIndex, uniform } from 'three/tsl';
import { Vector3, type WebGPURenderer } from 'three/webgpu';

const prefersStillness = matchMedia('(prefers-reduced-motion: reduce)').matches;

const STARS = 20_000;
const COUNT = 2 * STARS;
/** Of the simulation, whose unit is the mass of a core, and about the radius of a galaxy. */
const STEP = 0.025;
const STEPS_AT_REST = 220;
const STEPS_AT_MOST = 900;
/** Smooths gravity near a core. */
const SOFTNESS = 0.15;
const BOUNDS = { min: [-30, -30, -30], max: [30, 30, 30] } as const;

/** Two cores on a parabola about each other, before they meet. */
const START = { place: new Vector3(-1.9, -0.55, 0), velocity: new Vector3(0.44, -0.14, 0) };
/** Axes that the galaxies turn about. */
const AXES = [new Vector3(0.15, 0.3, 1).normalize(), new Vector3(-0.55, -0.2, 1).normalize()];
const COLORS = [
  { middle: [1, 0.95, 0.8], rim: [1, 0.5, 0.2] },
  { middle: [0.9, 0.95, 1], rim: [0.3, 0.55, 1] },
];

/** The same numbers in each run, 0…1. */
function randomNumbers() {
  let state = 1;
  return () => {
    state = (16807 * state) % 2147483647;
    return state / 2147483647;
  };
}

/** Two discs of stars on circular orbits: x, y, z of each, and r, g, b. */
function discs() {
  const [positions, velocities, colors] = [0, 0, 0].map(() => new Float32Array(3 * COUNT));
  const random = randomNumbers();
  const [across, along] = [new Vector3(), new Vector3()];
  for (let i = 0; i < COUNT; i++) {
    const galaxy = i < STARS ? 0 : 1;
    const side = galaxy === 0 ? 1 : -1;
    // The middle is denser.
    const radius = 0.06 + 0.94 * random() ** 1.3;
    const angle = 2 * Math.PI * random();
    across.set(0, 1, 0).cross(AXES[galaxy]).normalize();
    along.crossVectors(AXES[galaxy], across);
    const place = across
      .clone()
      .multiplyScalar(radius * Math.cos(angle))
      .addScaledVector(along, radius * Math.sin(angle));
    const speed = radius / (radius ** 2 + SOFTNESS ** 2) ** 0.75;
    const velocity = AXES[galaxy].clone().cross(place).setLength(speed);
    place.addScaledVector(START.place, side).toArray(positions, 3 * i);
    velocity.addScaledVector(START.velocity, side).toArray(velocities, 3 * i);
    const { middle, rim } = COLORS[galaxy];
    const part = Math.min(1, 1.4 * radius);
    colors.set(
      middle.map((channel, k) => channel + (rim[k] - channel) * part),
      3 * i,
    );
  }
  return { positions, velocities, colors };
}

/** Galaxies that pass each other: stars fall towards two cores, and a compute shader moves them. */
class Encounter {
  readonly data: ReturnType<typeof makeGpuSplats>;
  readonly #renderer: WebGPURenderer;
  readonly #core = uniform(new Vector3());
  readonly #velocity = new Vector3();
  readonly #begin;
  readonly #move;
  #steps = 0;

  constructor(renderer: WebGPURenderer) {
    const start = discs();
    const [places, velocities] = [
      instancedArray(start.positions, 'vec3'),
      instancedArray(start.velocities, 'vec3'),
    ];
    const [positions, motion] = [instancedArray(COUNT, 'vec3'), instancedArray(COUNT, 'vec3')];
    this.#renderer = renderer;
    this.#begin = Fn(() => {
      positions.element(instanceIndex).assign(places.element(instanceIndex));
      motion.element(instanceIndex).assign(velocities.element(instanceIndex));
    })().compute(COUNT);
    this.#move = Fn(() => {
      const position = positions.element(instanceIndex).toVar();
      const velocity = motion.element(instanceIndex).toVar();
      // The cores lie on either side of the origin.
      for (const core of [this.#core, this.#core.negate()]) {
        const way = core.sub(position).toVar();
        const squared = way.dot(way).add(SOFTNESS ** 2);
        velocity.addAssign(way.mul(STEP).div(squared.mul(squared.sqrt())));
      }
      motion.element(instanceIndex).assign(velocity);
      positions.element(instanceIndex).assign(position.add(velocity.mul(STEP)));
    })().compute(COUNT);
    const scales = instancedArray(new Float32Array(3 * COUNT).fill(0.009), 'vec3');
    const opacities = instancedArray(new Float32Array(COUNT).fill(0.75), 'float');
    const colors = instancedArray(start.colors, 'vec3');
    this.data = makeGpuSplats(renderer, { positions, scales, colors, opacities, bounds: BOUNDS });
    this.restart();
    for (let i = 0; i < STEPS_AT_REST; i++) this.step();
  }

  restart(): void {
    this.#core.value.copy(START.place);
    this.#velocity.copy(START.velocity);
    this.#steps = 0;
    this.#renderer.compute(this.#begin);
    this.data.changed();
  }

  step(): void {
    if (this.#steps++ > STEPS_AT_MOST) this.restart();
    const core = this.#core.value;
    const squared = 4 * core.lengthSq() + SOFTNESS ** 2;
    this.#velocity.addScaledVector(core, (-2 * STEP) / squared ** 1.5);
    core.addScaledVector(this.#velocity, STEP);
    this.#renderer.compute(this.#move);
    this.data.changed();
  }
}

export default function GpuParticles() {
  const [isMoving, setMoving] = useState(!prefersStillness);
  const [round, setRound] = useState(0);
  return (
    <>
      <SplatCanvas flat frameloop="demand" camera={{ position: [0, 0, 6], fov: 50, near: 0.05 }}>
        <color attach="background" args={['#05060d']} />
        <Galaxies isMoving={isMoving} round={round} />
        <OrbitControls />
      </SplatCanvas>
      <form className="panel">
        <button type="button" onClick={() => setRound(round + 1)}>
          Once more
        </button>
        <label>
          <input type="checkbox" checked={isMoving} onChange={() => setMoving(!isMoving)} /> Moving
        </label>
      </form>
    </>
  );
}

/** @param round restarts the encounter when it grows. */
function Galaxies({ isMoving, round }: { isMoving: boolean; round: number }) {
  const renderer = useThree(({ gl }) => gl as unknown as WebGPURenderer);
  const [encounter] = useState(() => new Encounter(renderer));
  useEffect(() => {
    if (round > 0) encounter.restart();
  }, [encounter, round]);
  useEffect(() => {
    // The first step requests a frame, and so do all others.
    if (isMoving) encounter.step();
  }, [encounter, isMoving]);
  useFrame(() => {
    if (isMoving) encounter.step();
  });
  return <Splats src={encounter.data} />;
}
