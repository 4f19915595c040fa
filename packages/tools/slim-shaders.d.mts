import type { Plugin } from 'vite';

export function slimShaders(): Plugin;
