import type { Mutation } from '@websplatter/hardcases';
import { useEffect, useState } from 'react';
import { CaseImages } from './case-images.ts';

/** Freed with what shows them; null at first, and while they are not wanted. */
export function useCaseImages(areWanted: boolean, mutation?: Mutation): CaseImages | null {
  const [images, setImages] = useState<CaseImages | null>(null);
  useEffect(() => {
    if (!areWanted) return;
    const made = new CaseImages(mutation);
    setImages(made);
    return () => made.destroy();
  }, [areWanted, mutation]);
  return images;
}
