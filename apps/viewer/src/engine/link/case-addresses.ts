import type { Link } from '../../state/messages.ts';
import { galleryAddress } from './lab-address.ts';

/** Query of the page's URL for a case. */
export function addressOf(name: string): string {
  return `?scene=${hardCaseScene(encodeURIComponent(name))}`;
}

/** Value of `?scene=` for a case. */
export function hardCaseScene(name: string): string {
  return `hard:${name}`;
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
    const gallery = galleryAddress();
    this.links = gallery ? [...links, { label: 'All hard cases', href: gallery }] : links;
  }
}
