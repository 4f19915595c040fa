import type { Link } from '../state/messages.ts';
import { GALLERY_SCENE } from './addressed-scene.ts';

export const GALLERY_ADDRESS = `?scene=${GALLERY_SCENE}`;

export function addressOf(name: string): string {
  return `${GALLERY_ADDRESS}:${encodeURIComponent(name)}`;
}

/** Query of a case's page, which shows the expected image beside this device's. */
export function caseAddress(name: string): string {
  return `${GALLERY_ADDRESS}&case=${encodeURIComponent(name)}`;
}

/** Value of `?scene=` for a case. */
export function hardCaseScene(name: string): string {
  return `${GALLERY_SCENE}:${name}`;
}

/** The case that `?scene=` asks for; null if it asks for another scene. */
export function hardCaseNameIn(scene: string | null | undefined): string | null {
  const prefix = hardCaseScene('');
  return scene?.startsWith(prefix) ? scene.slice(prefix.length) : null;
}

/** The case does not exist or cannot be opened. */
export class HardCaseError extends Error {
  override readonly name = 'HardCaseError';
  readonly links: readonly Link[];

  constructor(message: string, closest: readonly string[] = []) {
    super(message);
    const links = closest.map((name) => ({ label: name, href: addressOf(name) }));
    this.links = [...links, { label: 'All hard cases', href: GALLERY_ADDRESS }];
  }
}
