// Where in the page one is: #/, #/jobs/12, #/history.
import { useEffect, useState } from 'preact/hooks';

export type Route = { view: 'now' } | { view: 'history' } | { view: 'job'; id: number };

export const jobHref = (id: number): string => `#/jobs/${id}`;

export function routeOf(hash: string): Route {
  const job = /^#\/jobs\/(\d{1,15})$/.exec(hash);
  if (job) return { view: 'job', id: Number(job[1]) };
  return hash === '#/history' ? { view: 'history' } : { view: 'now' };
}

export function useRoute(): Route {
  const [route, setRoute] = useState(routeOf(location.hash));
  useEffect(() => {
    const turned = (): void => {
      setRoute(routeOf(location.hash));
      scrollTo(0, 0);
    };
    addEventListener('hashchange', turned);
    return () => removeEventListener('hashchange', turned);
  }, []);
  return route;
}
