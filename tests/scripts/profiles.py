"""Profile-likelihood intervals of two data sets of Bates and Watts (1988), Nonlinear Regression Analysis: BOD (table A1.4) and Puromycin,
treated (table A1.1). Prints the numbers that tests/it/intervals.rs expects. Needs numpy and scipy; run as it stands."""
import numpy as np
from scipy.optimize import least_squares, brentq
from scipy.stats import t as T
# BOD of Bates and Watts (1988), table A1.4: y = a (1 - exp(-b x))
x=np.array([1,2,3,4,5,7.]);y=np.array([8.3,10.3,19,16,15.6,19.8])
f=lambda p: p[0]*(1-np.exp(-p[1]*x))
r=least_squares(lambda p:y-f(p),[20,.5],xtol=1e-15,ftol=1e-15,gtol=1e-15)
s0=2*r.cost; n,p=6,2; s2=s0/(n-p); q=T.ppf(.975,n-p)
print(r.x,np.sqrt(s2))
J=r.jac; se=np.sqrt(np.diag(np.linalg.inv(J.T@J))*s2); print('lin',r.x-q*se,r.x+q*se)
def best_a(a): # min over b
    bs=[least_squares(lambda b:y-a*(1-np.exp(-b[0]*x)),[b0],xtol=1e-15,ftol=1e-15,gtol=1e-15).cost*2 for b0 in (.1,.5,1,3)]
    return min(bs)
def best_b(b):
    g=1-np.exp(-b*x); a=(g@y)/(g@g); return np.sum((y-a*g)**2)
za=lambda a: np.sqrt(max(best_a(a)-s0,0)/s2)-q
zb=lambda b: np.sqrt(max(best_b(b)-s0,0)/s2)-q
print('a', brentq(za, 10, r.x[0]-1e-6, xtol=1e-12), brentq(za, r.x[0]+1e-6, 1000, xtol=1e-12))
print('b', brentq(zb, 1e-3, r.x[1]-1e-6, xtol=1e-12), brentq(zb, r.x[1]+1e-6, 100, xtol=1e-12))
q = T.ppf(.995, n-p)
print('b at 99%', brentq(zb, -1, -1e-3, xtol=1e-12), 'open: at 1e6 still below by', zb(1e6))
q = T.ppf(.975, n-p)
# Puromycin treated
x=np.array([.02,.02,.06,.06,.11,.11,.22,.22,.56,.56,1.1,1.1]);y=np.array([76,47,97,107,123,139,159,152,191,201,207,200.])
fp=lambda p:p[0]*x/(p[1]+x)
r=least_squares(lambda p:y-fp(p),[200,.06],xtol=1e-15,ftol=1e-15,gtol=1e-15); s0=2*r.cost;n=12;s2=s0/10;q=T.ppf(.975,10)
def bV(v): return 2*least_squares(lambda k:y-v*x/(k[0]+x),[.06],xtol=1e-15,ftol=1e-15,gtol=1e-15).cost
def bK(k): g=x/(k+x); v=(g@y)/(g@g); return np.sum((y-v*g)**2)
zV=lambda v:np.sqrt(max(bV(v)-s0,0)/s2)-q
zK=lambda v:np.sqrt(max(bK(v)-s0,0)/s2)-q
print(repr(r.x))
print(brentq(zV,150,r.x[0]-1e-6),brentq(zV,r.x[0]+1e-6,300),brentq(zK,.01,r.x[1]-1e-9),brentq(zK,r.x[1]+1e-9,.3))
