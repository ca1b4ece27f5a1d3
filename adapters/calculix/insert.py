#!/usr/bin/env python3
"""Puts the calls of glue.c into nonlingeo.c of CalculiX 2.20:

    python3 insert.py FOLDER_OF_THE_SOURCES

A second run changes nothing. Ends with status 1, and changes nothing, if a place is not found: another version.
"""
import sys
from pathlib import Path

# A text of nonlingeo.c, which of its occurrences from 0, and what goes before it.
PLACES = [
    ('#include "mortar.h"', 0, '#include "glue.h"'),
    ("if(*mortar!=1){", 0, "static ITG by_faces=0;if(feti_wish()){by_faces=by_faces||(*mortar>0);*mortar=0;}"),
    ("NNEW(xmastnor,double,3*nmastnode[*ntie]);", 0,
     "if(feti_wish())\n"
     "  feti_begin((*nmethod==1)&&(*ithermal<2)&&(*isolver==0),by_faces,*ntie,tieset,set,*nset,tietol,itietri,koncont,itiefac,islavsurf,\n"
     "    nslavnode,islavnode,ipkon,kon,lakon,*nk,mt,neq[0],elcon,(*ncmat_+1)**ntmat_,nactdof,memmpc_,co,vold,\n"
     "    xbounact,ipompc,nodempc,coefmpc);"),
    # The first call moves the nodes of ADJUST; its contact elements are forgotten.
    (" contact(&ncont,ntie,", 0, "if(!feti_wish()||((*istep==1)&&(iit<0)))"),
    ("/* check whether, for a dynamic calculation, contact damping", 0, "if(feti_wish()&&(icutb==0)){*ne=ne0;*nkon=nkon0;nasym=0;feti_commit(co,vold);}"),
    (" contact(&ncont,ntie,", 1, "if(!feti_wish())"),
    ("if((icascade>0)||((ncont!=0)&&(*iexpl<=1)))", 0, "if(!feti_wish()||(icascade>0))"),
    ("if((icascade>0)||(ncont!=0)){", 0, "if(!feti_wish()||(icascade>0))"),
    ("spooles(ad,au,adb,aub,&sigma,b,icol,irow,&neq[0]", 1,
     "if((ncont!=0)&&feti_wish()){\n"
     "  feti_table(nactdof,xbounact,ipompc,nodempc,coefmpc,co,vold);\n"
     "  if(feti_again(ad,au,jq,irow,b,iperturb[1])){DOUMEMSET(sti,0,6*mi[0]*ne0,0.);SFREE(ad);SFREE(au);continue;}\n"
     "}else"),
    ("/* calculating the ratio of the smallest to largest pressure", 0,
     "if((ncont!=0)&&feti_wish()) feti_residual(b,qa,co,vold);"),
]


def find(text, what, occurrence):
    at = -1
    for _ in range(occurrence + 1):
        at = text.find(what, at + 1)
        if at < 0:
            sys.exit(f"insert.py: nonlingeo.c has no {what!r} number {occurrence}: is this CalculiX 2.20?")
    return at


def main():
    path = Path(sys.argv[1]) / "nonlingeo.c"
    text = path.read_text()
    if "glue.h" in text:
        return
    found = sorted(((find(text, what, occurrence), lines) for what, occurrence, lines in PLACES), reverse=True)
    for at, lines in found:
        text = text[:at] + lines + "\n" + text[at:]
    path.write_text(text)


main()
