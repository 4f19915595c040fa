import { ADDRESS_NAMES } from '../scene/addressed-scene.ts';

/** What the viewer and the benchmark both read of an address: scene and accuracy. */
const SHARED_NAMES: readonly string[] = [...ADDRESS_NAMES, 'scene', 'accuracy'];

/** The benchmark of the scene, and with the accuracy, that the viewer's address asks for. */
export function benchAddress(query: URLSearchParams): string {
  return addressOf([['bench', ''], ...shared(query)]);
}

/** The viewer on the scene of a benchmark's address. */
export function viewerAddress(query: URLSearchParams): string {
  return addressOf(shared(query));
}

function shared(query: URLSearchParams): [string, string][] {
  return [...query].filter(([name]) => SHARED_NAMES.includes(name));
}

function addressOf(parameters: [string, string][]): string {
  // A bare `bench` reads better than `bench=`.
  return `?${new URLSearchParams(parameters)}`.replace(/\bbench=(?=&|$)/, 'bench');
}
